"""Objections of the type checker that do not show that a line fails: Python checks no types, and callers need not follow hints."""

from __future__ import annotations

import ast
import builtins
import re
import sys
from collections.abc import Collection, Iterable, Iterator

from ros2lab.diagnose.checking.call_forms import argument_at, call_at
from ros2lab.diagnose.checking.checked_copies import RULES, checked
from ros2lab.diagnose.checking.edits import Edit
from ros2lab.diagnose.checking.trials import revealed_by, type_of
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.interfaces import is_interface
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, parameters
from ros2lab.diagnose.sources.syntax_parts import all_parameters, by_parameter, own_parameters

_OF_CALLS = (*RULES, "no-matching-overload")  # what fails when it runs, too
_CONTRADICTS = re.compile(
    r"Object of type `(?!None`).+` is not assignable to |Invalid subscript assignment .+ value of type `(?!None`)"
)


def is_doubtful(row: re.Match[str], said: re.Match[str], source: PythonSource, own: NodeSources) -> bool:
    """Return whether a line may be right although the type checker objects to it."""
    line, column = int(row["line"]), int(row["column"]) - 1
    if _is_told_by_member(row, source):
        return True
    match row["rule"]:
        case "missing-attribute" if said[0].startswith("Module"):
            return _is_of_others(said["owner"], own)
        case "missing-attribute" if said[0].startswith("Class") and _is_decorated_with(
            said["owner"], said["name"]
        ):
            return True
        case "not-callable":
            calls = [n for n in source.calls if n.lineno == line]
            called = [call.func for call in calls if call.col_offset == column]
            # Of a union it names only the type that cannot be called.
            is_whole = any(type_of(source, function) == said["owner"] for function in called)
            return not is_whole or _uses_unnamed_self(source, line)
        case "invalid-argument-type":
            return _is_only_annotated(row, said, Spot(source, line), own)
    return _uses_unnamed_self(source, line)


def _is_told_by_member(row: re.Match[str], source: PythonSource) -> bool:
    """Return whether an objection is about a value of several types, and tells only which of them does not fit.

    So it does of `counts['n'] += 1` where other elements are strings, and of a call of one of several functions.
    The value may be of another type whenever the line runs.
    """
    spot, column = Spot(source, int(row["line"])), int(row["column"]) - 1
    if row["rule"] == "unsupported-operator":
        starts = (n for n in source.nodes if isinstance(n, ast.AugAssign) and n.lineno == spot.line)
        added = next((n for n in starts if n.col_offset == column), None)
        if added is None:
            return False
        # An assignment with a plain operator, which reads what it changes.
        read = f"{ast.unparse(added.target)} = reveal_type({ast.unparse(added.target)})"
        return is_of_several(revealed_by(source, Edit(added, read)))
    call = call_at(spot, column, row["rule"])
    return call is not None and is_of_several(type_of(source, call.func))


def is_of_several(kind: str) -> bool:
    """Return whether a type is a union, and not only has one in its brackets."""
    inner = re.compile(r"\([^()]*\)|\[[^\[\]]*\]")
    while (bare := inner.sub("", kind)) != kind:
        kind = bare
    return " | " in kind.partition(" -> ")[0]


def _is_of_others(module: str, own: NodeSources) -> bool:
    """Return whether a module's members differ from version to version, or are only known when it runs.

    So they are of a module that Python has on other systems only.
    """
    top = module.partition(".")[0]
    if top in sys.stdlib_module_names:
        return interfaces.importable_names(module) is None
    return top not in interfaces.PACKAGES and module not in own.sources


def _is_decorated_with(kind: str, name: str) -> bool:
    """Return whether a decorator of a class of rclpy gets a name as a text, and may give it to the class."""
    found = (interfaces.class_in(home, kind) for home in interfaces.inner_homes_of(kind))
    decorators = (decorator for known in found if known for decorator in known.decorator_list)
    return any(getattr(node, "value", None) == name for above in decorators for node in ast.walk(above))


def _uses_unnamed_self(source: PythonSource, line: int) -> bool:
    """Return whether a line uses the first parameter of a function in a class that is not called self, as in a decorator."""
    owners = (node for node in source.nodes if isinstance(node, ast.ClassDef))
    around = (node for owner in owners for node in owner.body if isinstance(node, Function))
    around = (node for node in around if node.lineno < line <= (node.end_lineno or 0))
    first = {parameter.arg for node in around for parameter in parameters(node)[:1]} - {"self", "cls"}
    names = (node for node in source.nodes if isinstance(node, ast.Name) and node.lineno == line)
    return any(node.id in first for node in names)


def _is_only_annotated(row: re.Match[str], said: re.Match[str], spot: Spot, own: NodeSources) -> bool:
    """Return whether only the annotation of one of the package's own functions rejects an argument, and its body does not."""
    call = call_at(spot, int(row["column"]) - 1, row["rule"])
    value = argument_at(call, spot.line, int(row["column"]) - 1) if call else None
    home, function = _own_function(said["owner"], own)
    if call is None or value is None or function is None or home is None:
        return home is not None
    given = by_parameter(call, [parameter.arg for parameter in own_parameters(function)])
    name = next((name for name, argument in given.items() if argument is value), "")
    written = next((p.annotation for p in all_parameters(function) if p.arg == name and p.annotation), None)
    kind = type_name(said["given"])
    if written is None or not kind or home.path is None:
        return True
    before, after = checked(home, [home.text.encode(), Edit(written, kind).of(home)])
    objections = {(row.line, row.said) for row in after if row.rule in _OF_CALLS} - {
        (row.line, row.said) for row in before
    }
    return all(f"`{said['owner']}`" in text for _, text in objections)


def _own_function(called: str, own: NodeSources) -> tuple[PythonSource | None, Function | None]:
    """Return the file and the definition of one of the package's own functions; no definition for a class of fields."""
    *_, owner, name = ["", *called.split(".")]
    for source in own.sources.values():
        for node in source.nodes:
            if isinstance(node, Function) and node.name == called:
                return source, node
            if isinstance(node, ast.ClassDef) and node.name == owner:
                methods = {inner.name: inner for inner in node.body if isinstance(inner, Function)}
                has_fields = any(isinstance(inner, ast.AnnAssign) for inner in node.body)
                if name in methods or (has_fields and name in ("__init__", "__new__")):
                    return source, methods.get(name)
    return None, None


def type_name(kind: str) -> str:
    """Return the name of a plain type, also for a value such as `Literal[3]`; empty for another type."""
    value = re.fullmatch(r"Literal\[(.+)\]", kind)
    try:
        return type(ast.literal_eval(value[1])).__name__ if value else kind if kind.isidentifier() else ""
    except (ValueError, SyntaxError):
        return ""


def contradicted(source: PythonSource, said: Iterable[tuple[int, str]]) -> set[tuple[str, str]]:
    """Return the names whose types the code contradicts on some lines, by what is said of them, each with its function.

    What is stored in an item, or in an attribute of one, contradicts the type of what holds it.
    """
    lines = {line for line, text in said if _CONTRADICTS.match(text)}
    stored = [n for n in source.nodes if isinstance(getattr(n, "ctx", None), ast.Store)]
    changed = [node for node in stored if getattr(node, "lineno", 0) in lines]
    for node in changed:
        inner = getattr(node, "value", None)
        if inner and (isinstance(node, ast.Subscript) or isinstance(inner, ast.Subscript)):
            changed.append(inner)
    return {_placed(source, node) for node in changed if isinstance(node, (ast.Name, ast.Attribute))}


def is_asked_for(source: PythonSource, value: ast.expr) -> bool:
    """Return whether the function around a value asks for its type, where the type checker does not follow that.

    It follows names, attributes and items at a constant place, and neither other items nor what a call returns.
    """
    items = [n for n in ast.walk(value) if isinstance(n, (ast.Call, ast.Subscript))]
    if all(isinstance(getattr(item, "slice", None), ast.Constant) for item in items):
        return False
    named, around = {*map(ast.unparse, (value, *items))}, Spot(source, value.lineno).function
    asking = (c for c in source.calls if around is None or c in ast.walk(around))
    asking = (c for c in asking if c.args and ast.unparse(c.func) in ("isinstance", "type"))
    return any(ast.unparse(call.args[0]) in named for call in asking)


def is_contradicted(source: PythonSource, line: int, names: Collection[tuple[str, str]]) -> bool:
    """Return whether a line uses one of the names whose annotations are contradicted."""
    used = (node for node in source.nodes if isinstance(node, (ast.Name, ast.Attribute)))
    return bool(names) and any(_placed(source, node) in names for node in used if node.lineno == line)


def _placed(source: PythonSource, node: ast.Name | ast.Attribute) -> tuple[str, str]:
    """Return the name of the function around a variable, and its own; an attribute is known in every function."""
    function = Spot(source, node.lineno).function if isinstance(node, ast.Name) else None
    return function.name if function else "", ast.unparse(node)


_ANYTHING = "'_anything_'"  # a type that no file defines is one about which nothing is known
_DEEPEST = 3  # calls through which a value is followed


def is_misled(source: PythonSource, line: int, rule: str, own: NodeSources) -> bool:
    """Return whether a parameter gets something other than its hint says, with which the line is right.

    Python does not check hints, so what a parameter gets counts. Where that is not seen, a hint is trusted: all of
    them if nothing here calls the function, and otherwise only that of a message, which is seldom wrong.
    """
    for function in _around(source, line):
        for parameter in all_parameters(function):
            if parameter.annotation is None:
                continue
            given = [*_given(source, function, parameter.arg, own)]
            is_message = is_interface((source.resolve(parameter.annotation) or "").removesuffix(".Request"))
            kinds = [f"'{kind}'" for kind in given if kind]
            if not kinds and (not given or is_message):
                continue
            copies = checked(
                source, [Edit(parameter.annotation, kind).of(source) for kind in kinds or [_ANYTHING]]
            )
            if any(all((row.line, row.rule) != (line, rule) for row in rows) for rows in copies):
                return True
    return False


def _around(source: PythonSource, line: int) -> list[Function]:
    kinds = (node for node in source.nodes if isinstance(node, Function))
    return [node for node in kinds if node.lineno < line <= (node.end_lineno or 0)]


def _given(
    source: PythonSource, function: Function, name: str, own: NodeSources, depth: int = 0
) -> Iterator[str]:
    """Yield the types that a parameter gets from ROS and from each call, as the file writes them; empty if unknown."""
    names = [parameter.arg for parameter in own_parameters(function)]
    for creation, called in own.callbacks():
        if called is function and name in names:
            known = creation.arguments or {}
            kind = known.get("msg_type") or known.get("srv_type")
            part = ("", "") if "msg_type" in known else (".Request", ".Response")
            number = names.index(name)
            is_seen = kind is not None and creation.source is source and number < len(part)
            yield f"{ast.unparse(kind)}{part[number]}" if kind is not None and is_seen else ""
    for home in own.sources.values() if depth < _DEEPEST else ():
        direct = set[int]()
        for call in home.nodes:
            if isinstance(call, ast.Call) and last_name(call.func) == function.name:
                direct.add(id(call.func))
                value = by_parameter(call, names).get(name)
                yield from _kinds(home, value, source, own, depth) if value is not None else ()
        # Whatever it is passed to may call it with anything.
        yield from ("" for node in home.nodes if last_name(node) == function.name and id(node) not in direct)


def _kinds(
    home: PythonSource, value: ast.expr, source: PythonSource, own: NodeSources, depth: int
) -> Iterator[str]:
    """Yield the types of an argument, where it is a parameter itself those that it gets."""
    around = _around(home, value.lineno)
    handed = [f for f in around if ast.unparse(value) in [parameter.arg for parameter in parameters(f)]]
    found = [kind for f in handed for kind in _given(home, f, ast.unparse(value), own, depth + 1)]
    if any(found):
        yield from (kind if kind.partition(".")[0] in source.names else "" for kind in found)
        return
    kind = type_name(type_of(home, value))
    yield kind if kind in dir(builtins) or kind in source.names else ""
