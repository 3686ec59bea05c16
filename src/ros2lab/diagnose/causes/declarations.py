"""Parameters that are read before they are declared, or declared twice."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from ros2lab import every_node
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_arguments import sections_in
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.parameter_faults import declared_in
from ros2lab.diagnose.nodes.read_parameters import default_by_use, of_another_node
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.spots import Spot, place_of, spot_at
from ros2lab.diagnose.sources.bindings import bindings
from ros2lab.diagnose.sources.interfaces import node_members
from ros2lab.diagnose.sources.literals import Literals, Names, argument_of, first_texts, looped
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    given_to,
    own_nodes,
    parameters,
    read_text,
)
from ros2lab.diagnose.sources.spelling import nearest
from ros2lab.diagnose.sources.syntax_parts import removal

_OPTION = "automatically_declare_parameters_from_overrides"
_DECLARES = ("declare_parameter", "declare_parameters", "set_parameters", "set_parameters_atomically")


@dataclass(frozen=True)
class _Use:
    """A call of a node's method, and the expression in it that names parameters.

    Attributes:
        names: the parameters that the error is about.
        lines: the student's lines in the traceback, as (file, line), the innermost first.
    """

    look: Look
    sources: NodeSources
    source: PythonSource
    spot: Spot
    owner: NodeClass | None
    function: Function | None
    call: ast.Call
    named: ast.expr
    names: tuple[str, ...]
    lines: tuple[tuple[str, int], ...]

    @property
    def node(self) -> str:
        """The expression for the node, such as `self`."""
        return ast.unparse(self.call.func.value) if isinstance(self.call.func, ast.Attribute) else "self"

    @property
    def text(self) -> str:
        """The names, joined by "and"."""
        return " and ".join(self.names)

    @property
    def is_in_callback(self) -> bool:
        """Whether its function is a callback, or is called by one."""
        callbacks = [function for _, function in self.sources.callbacks()]
        around = [self.function, *(source.function_at(call.lineno) for source, call in self.calls)]
        return any(caller is function for caller in around if caller is not None for function in callbacks)

    @property
    def calls(self) -> list[tuple[PythonSource, ast.Call]]:
        """The calls of its function; empty for a constructor."""
        name = self.function.name if self.function else "__init__"
        return [*Literals(self.sources).calls(name)] if name != "__init__" else []

    @property
    def given(self) -> Names:
        """The names that the expression may hold, as far as they are known."""
        return Literals(self.sources).names(self.source, self.named)


def declaration_fault(error: ErrorText, look: Look) -> Finding | None:
    """Return why a parameter is undeclared where it is read, or declared twice; None for another error."""
    report = error.report
    told = {
        "ParameterNotDeclaredException": _undeclared,
        "ParameterAlreadyDeclaredException": _declared_before,
    }
    if report is None or report.kind not in told:
        return None
    names = re.findall(r"[\w./-]+", report.message.partition(": ")[2])
    use = _use_of(tuple(dict.fromkeys(names)), error, look)
    return told[report.kind](use) if use else None


def _use_of(names: tuple[str, ...], error: ErrorText, look: Look) -> _Use | None:
    """Return the call on an error's line that names its parameters; None if there is none."""
    frames = error.own
    places = [place_of([frame], look).rpartition(":") for frame in frames]
    spot = spot_at(place_of(frames, look), look)
    lines = tuple((file, int(line)) for file, _, line in places if line.isdigit())
    for sources in map(look.sources, look.packages):
        for source in sources.sources.values():
            if places and source.shown == places[0][0]:
                uses = _uses_at(look, sources, source, spot, lines)
                return next((found for use in uses if (found := _about(use, names))), None)
    return None


def _uses_at(
    look: Look, sources: NodeSources, source: PythonSource, spot: Spot, lines: tuple[tuple[str, int], ...]
) -> Iterator[_Use]:
    """Yield a use for each expression in a node's method call on these lines that may name parameters."""
    known = node_members()
    scoped = [entry for entry in sources.scoped(source) if getattr(entry[2], "lineno", 0) in spot.lines]
    for owner, function, call in reversed(scoped):  # the innermost first
        if isinstance(call, ast.Call) and getattr(call.func, "attr", "") in known:
            inside = {id(node) for node in ast.walk(call)}
            for _, _, node in scoped:
                if isinstance(node, ast.expr) and id(node) in inside and not isinstance(node, ast.Call):
                    yield _Use(look, sources, source, spot, owner, function, call, node, (), lines)


def _about(use: _Use, names: tuple[str, ...]) -> _Use | None:
    """Return a use with the names that an error is about, or else those not declared; None if none remain."""
    given, declared = use.given, declared_in(use.sources) or {}
    meant = tuple(name for name in names or given if name in given and (names or name not in declared))
    return replace(use, names=meant) if meant else None


def _undeclared(use: _Use) -> Finding:
    """Return a finding about an undeclared parameter, with a declaration in the terms of the line."""
    together = use.sources.around(use.source.name) or use.sources  # not the parameters of other programs
    name, declared = use.names[0], declared_in(together) or {}
    given = use.given
    _, origin = given[name]
    comes = ""
    if isinstance(origin, ast.Call):
        comes = f" The name comes from `{ast.unparse(origin)}` (line {origin.lineno})."
    there = f" Declared are: {', '.join(sorted(declared))}." if declared else ""
    is_list = isinstance(origin, (ast.List, ast.Tuple))
    is_list |= isinstance(use.sources.value(use.source, use.named), list)
    written = _declaring(
        use, [parameter for parameter in given if parameter not in declared] if is_list else []
    )
    text, here = ast.unparse(use.named), use.spot.lines.start
    where = f"above line {here}"
    if text == repr(name) and use.function and use.function.name not in ("__init__", "main"):
        where = "in the constructor, before it is read"
    option = next((line for line, _ in _options(use)), "")
    if option or (text != repr(name) and (use.is_in_callback or len(use.calls) > len(given))):
        where = f"above line {here}, and {written} below it, indented"
        written = f"`if not {use.node}.has_parameter({text}):`"
    more = "; replace the dots with its default value" if "...)" in written + where else ""
    close, fix = nearest(name, declared, 0.5), f"write {written} {where}{more}"
    if asked := of_another_node(name, declared, use.sources.node_names):
        (there, fix), close = asked, None
    fix = f"write {close!r} if that is meant; else {fix}" if close and not comes else fix
    cause = f"The parameter {name!r} is read and never declared.{comes}{there}"
    if option:
        cause = f"{_OPTION} ({option}) declares only what the node is given when it starts, and {name!r} was not given.{comes}"
        fix = f"give it a value when it starts, in the launch file or with -p {name}:=...; or {fix}"
    return Finding("parameter-undeclared", cause, use.source.at(here), fix)


def _declaring(use: _Use, listed: list[str]) -> str:
    """Return lines that declare what is read: each name of a list, or the name on the line, in its loop."""
    text, node = ast.unparse(use.named), use.node
    lines = [f"{node}.declare_parameter({name!r}, {_given_value(name, use.look)})" for name in listed]
    lines = lines or [f"{node}.declare_parameter({text}, {_default(use, use.names[0])})"]
    around = (
        n for n in use.spot.file.nodes if isinstance(n, ast.comprehension) and n.iter.lineno in use.spot.lines
    )
    if loop := next((n for n in around if text in map(ast.unparse, ast.walk(n.target))), None):
        head = f"for {ast.unparse(loop.target)} in {ast.unparse(loop.iter)}:"
        lines = [f"{head} {line}" for line in lines]
    return ", and ".join(f"`{line}`" for line in lines)


def _default(use: _Use, name: str) -> str:
    """Return a default for a parameter: the variable that comes with its name, or a value."""
    match use.named, use.function:
        case ast.Name(id=own), ast.FunctionDef() as function:
            taken = ("self", "cls", own, use.node)
            others = [parameter.arg for parameter in parameters(function) if parameter.arg not in taken]
            if own in [parameter.arg for parameter in parameters(function)] and len(others) == 1:
                return others[0]
            for node in ast.walk(function):
                match node:
                    case ast.For(target=ast.Tuple(elts=[ast.Name(id=first), ast.Name(id=second)])) if (
                        first == own
                    ):
                        return second
    return _given_value(name, use.look, default_by_use(use.source.nodes, use.call) or "...")


def _given_value(name: str, look: Look, fallback: str = "...") -> str:
    """Return the value that a file or launch file gives a parameter; the fallback if none does."""
    sections: list[Mapping[Any, Any]] = [n.values for file in look.launch_files for n in file.nodes]
    for path in (path for package in look.packages for path in package.parameter_files):
        sections += [values for _, values in sections_in(read_text(path))]
    known = (section[name] for section in sections if name in section)
    return next(
        (repr(value) for value in known if isinstance(value, (str, int, float, bool, list))), fallback
    )


def _declared_before(use: _Use) -> Finding:
    """Return a finding about what declared a parameter before this line, and what to change."""
    for told in (_by_every_node, _by_another_line, _by_an_option, _by_its_list, _by_another_time):
        if found := told(use):
            return found
    cause = f"The node has the parameter {use.text} already when this line declares it."
    return Finding("python-error", cause, use.source.at(use.call), _without(use))


def _by_every_node(use: _Use) -> Finding | None:
    own = next((name for name in use.names if name.partition(".")[0] in every_node.PARAMETERS), "")
    cause = f"Every node declares {own} by itself, so it is there already."
    return Finding("python-error", cause, use.source.at(use.call), _without(use)) if own else None


def _by_another_line(use: _Use) -> Finding | None:
    first = next(_others(use), None)
    if first is None:
        return None
    source, owner, call, given = first
    is_declared = getattr(call.func, "attr", "").startswith("declare")
    verb = "declares" if is_declared else "sets, and so declares,"
    base = owner and owner is not use.owner and owner.name.rpartition(".")[2]
    who = f"{base}, the base class of {use.owner.definition.name}," if base and use.owner else ""
    line = f"line {given.lineno}" if source is use.source else source.at(given)
    cause = f"{who or line} {verb} the parameter {use.text} already{f' ({line})' if who else ''}."
    fix = _without(use) + f", and change the default in {line} if you want another one" * bool(who)
    place = _asked_at(use) or use.source.at(use.call)
    return Finding("python-error", f"{cause[0].upper()}{cause[1:]}", place, fix)


def _by_an_option(use: _Use) -> Finding | None:
    for line, value in _options(use):
        cause = f"{_OPTION} ({line}) lets ROS declare each parameter that is given from outside when the node starts, and this line declares {use.text} again."
        fix = f"remove `{_OPTION}={value}` in {line}"
        return Finding("python-error", cause, use.source.at(use.call), fix)
    return None


def _options(use: _Use) -> Iterator[tuple[str, str]]:
    """Yield where the option is on by which a node declares what it is given, and the value that is written there."""
    for source in (use.sources.around(use.source.name) or use.sources).sources.values():
        for node in source.nodes:
            match node:
                case ast.keyword():
                    pairs: list[tuple[Any, ast.expr]] = [(node.arg, node.value)]
                case ast.Dict():
                    pairs = [
                        (getattr(k, "value", ""), v) for k, v in zip(node.keys, node.values, strict=True)
                    ]
                case _:
                    continue
            for name, value in pairs:
                if name == _OPTION and ast.unparse(value) != "False":
                    line = f"line {value.lineno}" if source is use.source else source.at(value)
                    yield line, ast.unparse(value)


def _by_its_list(use: _Use) -> Finding | None:
    name = use.named.id if isinstance(use.named, ast.Name) else ""
    for value, path in bindings(own_nodes(use.function or use.source.tree), name):
        given, number = looped(value, path) if path else (value, 0)
        texts = [*first_texts(use.sources.value(use.source, given), number)]
        if given and any(texts.count(name) > 1 for name in use.names):
            cause = (
                f"{use.text} is twice in `{ast.unparse(given)}`, but a parameter can be declared only once."
            )
            fix = f"remove one {use.names[0]!r} on line {given.lineno}"
            return Finding("python-error", cause, use.source.at(use.call), fix)
    return None


def _by_another_time(use: _Use) -> Finding | None:
    if use.function is None or not (use.is_in_callback or len(use.calls) > 1):
        return None
    cause = f"{use.function.name}() runs more than once, and a parameter can be declared only once."
    fix = "move this line into __init__, after super().__init__(...)"
    return Finding("python-error", cause, use.source.at(use.call), fix)


def _asked_at(use: _Use) -> str:
    """Return where a function is called with the name that it declares; empty if it names it itself."""
    names = [parameter.arg for parameter in parameters(use.function)] if use.function else []
    is_given = any(isinstance(n, ast.Name) and n.id in names for n in ast.walk(use.named))
    return "{}:{}".format(*use.lines[1]) if is_given and len(use.lines) > 1 else ""


def _others(use: _Use) -> Iterator[tuple[PythonSource, NodeClass | None, ast.Call, ast.expr]]:
    """Yield the other calls of the node's classes that declare a parameter, and the expression naming it."""
    lineage = [None, *use.sources.lineage(use.owner)[0]] if use.owner else [None]
    for source in use.sources.sources.values():
        for owner, _, call in use.sources.scoped(source):
            method = getattr(call.func, "attr", "") if isinstance(call, ast.Call) else ""
            if not isinstance(call, ast.Call) or method not in _DECLARES or owner not in lineage:
                continue
            values = given_to(call)
            naming = values[:1] if method == "declare_parameter" else [n for v in values for n in ast.walk(v)]
            for node in naming:
                given = Literals(use.sources).names(source, node) if isinstance(node, ast.expr) else {}
                for _, (home, where) in ((name, given[name]) for name in use.names if name in given):
                    asked = where if isinstance(where, ast.Call) else call
                    yield from _earlier(use, home, owner, call, asked)


def _earlier(
    use: _Use, home: PythonSource, owner: NodeClass | None, call: ast.Call, where: ast.expr
) -> Iterator[tuple[PythonSource, NodeClass | None, ast.Call, ast.expr]]:
    """Yield a declaration unless its line is in the traceback; if it is, the other calls of its function."""
    through = {line for file, line in use.lines if file == home.shown}
    if through.isdisjoint(range(where.lineno, (where.end_lineno or where.lineno) + 1)):
        yield home, owner, call, where
    elif where is not use.call and isinstance(where, ast.Call) and use.function:
        for source, caller in Literals(use.sources).calls(use.function.name):
            names = [parameter.arg for parameter in parameters(use.function)]
            texts = [argument_of(use.function, caller, name) for name in names]
            is_same = any(
                getattr(argument, "value", None) in use.names for argument in texts if argument is not None
            )
            if is_same and caller.lineno not in {line for file, line in use.lines if file == source.shown}:
                yield source, owner, call, caller


def _without(use: _Use) -> str:
    """Return how to remove a declaration; if its value is used, the parameter is read instead."""
    statement = next((n for n in use.source.nodes if isinstance(n, ast.Expr) and n.value is use.call), None)
    names = " and ".join(map(repr, use.names))
    if getattr(use.call.func, "attr", "") == "declare_parameters":
        return f"remove {names} from the list here"
    if _asked_at(use):
        return f"remove one of the two lines that ask for {names}"
    if statement is None:
        text = f"{use.node}.get_parameter({ast.unparse(use.named)})"
        return f"write `{text}` instead of `{ast.unparse(use.call)}`"
    last = statement.end_lineno or statement.lineno
    what = "this line" if last == statement.lineno else f"lines {statement.lineno} to {last}"
    return removal(use.source, statement, what)
