"""Functions whose `def` lacks a parameter: self, or one that the body uses and that callers pass."""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ros2lab.diagnose.code.bound_names import bound_in, global_names, unbound_names
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, parameters, walk
from ros2lab.diagnose.sources.spelling import nearest, snake_case
from ros2lab.diagnose.sources.syntax_parts import all_parameters, calls_in, is_property

CODE = "callback-arguments"
_OF_CLASSES = frozenset(("__new__", "__init_subclass__", "__class_getitem__"))


@dataclass(frozen=True)
class Definition:
    """A function of the files, or a method.

    Attributes:
        owner: the class whose body contains it; None for any other function.
    """

    source: PythonSource
    function: Function
    owner: ast.ClassDef | None

    @property
    def name(self) -> str:
        """What Python calls it, such as `Buoy.__init__`, apart from functions around it."""
        return f"{self.owner.name}.{self.function.name}" if self.owner else self.function.name

    @property
    def lacks_self(self) -> bool:
        """Whether it is a method whose first parameter, self, is missing for certain."""
        function = self.function
        is_static = bool(function.decorator_list) and not is_property(function)
        if self.owner is None or function.name in _OF_CLASSES or is_static:
            return False
        arguments = function.args
        if not parameters(function) and not arguments.vararg:
            uses = {n.attr for n in walk(self.owner) if is_self_attribute(n)}
            return function.name.startswith("__") or function.name in uses or _uses_self(self)
        is_certain = function.name.startswith("__") or self._is_given_all
        return _uses_self(self) or (is_certain and self._begins_with_a_value)

    @property
    def _is_given_all(self) -> bool:
        """Whether its class calls it on self, and always with a value for each of its parameters."""
        assert self.owner is not None
        named = (call for call in calls_in(walk(self.owner)) if is_self_attribute(call.func))
        counts = {len(c.args) for c in named if last_name(c.func) == self.function.name and not c.keywords}
        return counts == {len(parameters(self.function))} and not self.function.args.defaults

    @property
    def _begins_with_a_value(self) -> bool:
        """Whether its first parameter is only a value, and other methods of its class begin with self."""
        assert self.owner is not None
        first, *_ = [p.arg for p in parameters(self.function)] or [""]
        others = [
            parameters(n)[:1]
            for n in self.owner.body
            if isinstance(n, ast.FunctionDef) and n is not self.function
        ]
        asked = [n.value for n in walk(self.function) if isinstance(n, ast.Attribute)]
        is_object = first in ("self", "cls", "") or any(
            isinstance(n, ast.Name) and n.id == first for n in asked
        )
        return not is_object and any(names and names[0].arg == "self" for names in others)

    def with_more(self, names: Sequence[str], stars: tuple[str, str] = ("", "")) -> str:
        """Return the line of its def with more parameters, and with `*args` and `**kwargs` of some names unless they are empty."""
        function, arguments = self.function, copy.deepcopy(self.function.args)
        if self.lacks_self:
            arguments.args.insert(0, ast.arg("self"))
        arguments.args += [ast.arg(name) for name in names]
        arguments.defaults += [ast.Constant(None) for _ in names if arguments.defaults]
        arguments.vararg = ast.arg(stars[0]) if stars[0] else arguments.vararg
        arguments.kwarg = ast.arg(stars[1]) if stars[1] else arguments.kwarg
        returns = f" -> {ast.unparse(function.returns)}" if function.returns else ""
        word = "async def" if isinstance(function, ast.AsyncFunctionDef) else "def"
        return f"{word} {function.name}({ast.unparse(arguments)}){returns}:"


def definitions(source: PythonSource) -> Iterator[Definition]:
    """Yield all functions of a file, also those inside others."""
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
    owners = {
        id(inner): node for node in source.nodes if isinstance(node, ast.ClassDef) for inner in node.body
    }
    for node in source.nodes:
        if isinstance(node, kinds):
            yield Definition(source, node, owners.get(id(node)))


def lost_parameters(sources: NodeSources) -> Iterator[Finding]:
    """Yield functions whose def lacks what their body uses: self, or what a caller passes."""
    for source in sources.sources.values():
        for definition in definitions(source):
            if definition.lacks_self:
                yield without_self(definition)
            elif other := _by_another_name(definition):
                yield other
            elif unbound_names(source, definition.function) and (
                lost := lost_by(definition, [*calls_of(sources, definition)])
            ):
                yield lost


def _by_another_name(definition: Definition) -> Finding | None:
    """Return the finding about the only parameter that a body does not use, as it uses another name; else None."""
    function, source = definition.function, definition.source
    names = [name for name in unbound_names(source, function) if name not in _of_self(definition)]
    used = [n.id for n in walk(function) if isinstance(n, ast.Name)]
    free = [p for p in parameters(function)[definition.owner is not None :] if p.arg not in used]
    if len(names) != 1 or len(free) != 1 or function.args.defaults:
        return None
    name, old = names[0], free[0].arg
    others = global_names(source) | bound_in(function) - {old}
    if name[0].isupper() or nearest(name, others):
        return None  # it is written like a class, or misspells what the body has already
    if used.count(name) == 1 and len(parameters(function)) > 1 + (definition.owner is not None):
        return None  # it may be a slip in the body
    changed = copy.deepcopy(function)
    next(p for p in parameters(changed) if p.arg == old).arg = name
    cause = f"{function.name}() uses {name}, but its parameter is called {old}."
    right = Definition(source, changed, None).with_more([])
    return Finding(CODE, cause, source.at(function), f"write `{right}`")


def without_self(definition: Definition) -> Finding:
    """Return the finding about a method without self."""
    cause = f"{definition.function.name} is a method, but its first parameter, self, is missing."
    place = definition.source.at(definition.function)
    return Finding(CODE, cause, place, f"write `{definition.with_more([])}`")


def lost_by(definition: Definition, calls: Sequence[ast.Call], lacking: int = 0) -> Finding | None:
    """Return the finding about a def that lacks the parameters that its body uses; None if it lacks none.

    Args:
        definition: the function.
        calls: its calls, as far as they are known.
        lacking: how many arguments more than it takes it is given, as Python says; 0 if only the calls tell.
    """
    function = definition.function
    names = [n for n in unbound_names(definition.source, function) if n not in _of_self(definition)]
    if not names or function.args.vararg:
        return None
    stars = _starred(function, names)
    plain = [name for name in names if name not in stars]
    fitting = [call for call in calls if _passes(call, definition, plain, stars, lacking)]
    if not fitting and lacking != len(plain) and not (calls and any(stars) and lacking):
        return None
    if len(plain) > 1 and fitting:
        plain = _as_passed(fitting[0], plain)
    what = ", ".join([*plain, *(f"{'*' * n}{name}" for n, name in enumerate(stars, 1) if name)])
    cause = (
        f"{function.name}() uses {what}, which it is called with, but its def has no parameter of that name."
    )
    fix = f"write `{definition.with_more(plain, stars)}`"
    return Finding(CODE, cause, definition.source.at(function), fix)


def _of_self(definition: Definition) -> set[str]:
    """Return the names that a method only calls: they lack self and a dot, or a definition, rather than a parameter."""
    is_method = [parameter.arg for parameter in parameters(definition.function)[:1]] == ["self"]
    nodes = [*walk(definition.function)] if is_method else []
    called = {id(n.func): n.func.id for n in calls_in(nodes) if isinstance(n.func, ast.Name)}
    others = {n.id for n in nodes if isinstance(n, ast.Name) and id(n) not in called}
    return {*called.values()} - others


def surplus(call: ast.Call, definition: Definition) -> int:
    """Return how many positional arguments more than a function takes a call passes; negative for fewer."""
    takes = len(parameters(definition.function)) - (definition.owner is not None)
    return len(call.args) - takes


def _passes(
    call: ast.Call, definition: Definition, names: Sequence[str], stars: tuple[str, str], lacking: int
) -> bool:
    """Return whether a call passes what a def lacks: so many more values, or keywords of these names."""
    if any(isinstance(argument, ast.Starred) for argument in call.args):
        return False
    known = {parameter.arg for parameter in all_parameters(definition.function)}
    keywords = [keyword.arg for keyword in call.keywords if keyword.arg and keyword.arg not in known]
    more = surplus(call, definition) if lacking == 0 else lacking
    by_name = sum(keyword in names for keyword in keywords)
    is_open = more > len(names) - by_name and bool(stars[0])
    is_named = by_name == len(keywords) or bool(stars[1])
    return more + len(keywords) > 0 and is_named and (max(more, 0) == len(names) - by_name or is_open)


def _as_passed(call: ast.Call, names: Sequence[str]) -> list[str]:
    """Return parameters in the order in which a call passes variables of the same names, the others between."""
    given = [last_name(value) for value in call.args[-len(names) :]]
    rest = [name for name in names if name not in given]
    return [name if name in names else rest.pop(0) for name in given if name in names or rest] + rest


def calls_of(sources: NodeSources, definition: Definition) -> Iterator[ast.Call]:
    """Yield the calls of a function or, for `__init__`, of its class, found by their names."""
    is_made = definition.owner is not None and definition.function.name == "__init__"
    name = definition.owner.name if definition.owner and is_made else definition.function.name
    for source in sources.sources.values():
        yield from (call for call in source.calls if last_name(call.func) == name)


def named_by(call: ast.Call, number: int) -> list[str]:
    """Return names for the last arguments of a call, after what is passed there."""
    found: list[str] = []
    for value in call.args[-number:]:
        name = last_name(value) or "value"
        name = snake_case(name).strip("_") or "value"
        found.append(name if name not in found else f"{name}_{len(found) + 1}")
    return found


def _starred(function: Function, names: Sequence[str]) -> tuple[str, str]:
    """Return which of some names a function passes on as `*args` and as `**kwargs`; empty for none."""
    found = ["", ""]
    for node in walk(function):
        is_double = isinstance(node, ast.keyword) and node.arg is None
        if isinstance(node, ast.Starred) or is_double:
            name = getattr(getattr(node, "value", None), "id", "")
            found[is_double] = found[is_double] or (name if name in names else "")
    # By itself, `args` may be a plain parameter, as that of main() is.
    args = found[0] or ("args" if {"args", "kwargs"} <= {*names} else "")
    return args, found[1] or ("kwargs" if "kwargs" in names else "")


def _uses_self(definition: Definition) -> bool:
    return "self" in unbound_names(definition.source, definition.function)
