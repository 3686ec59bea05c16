"""Which names an expression may hold: written there, or from a variable, a loop or a call."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Iterator, Mapping
from typing import Any

from ros2lab.diagnose.sources.bindings import bindings
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, own_nodes, parameters
from ros2lab.diagnose.sources.syntax_parts import by_parameter, defaults_of

_DEEPEST = 5  # variables and calls through which a name is followed
# Each name with its origin: the expression itself, or the call that passes it to the function.
Names = Mapping[str, tuple[PythonSource, ast.expr]]


def names_given(
    sources: NodeSources,
    source: PythonSource,
    function: Function | None,
    node: ast.expr,
    depth: int = _DEEPEST,
) -> Names:
    """Return the names that an expression may hold, as far as they are known; for a list, its items."""
    value = sources.value(source, node)
    if isinstance(value, (str, list, dict)):
        return dict.fromkeys(first_texts([value] if isinstance(value, str) else value), (source, node))
    if depth == 0:
        return {}
    found: dict[str, tuple[PythonSource, ast.expr]] = {}
    match node:
        case ast.JoinedStr(values=parts):
            texts = [part.value if isinstance(part, ast.FormattedValue) else part for part in parts]
            found = dict(_joined(sources, source, function, texts, depth))
        case ast.BinOp(op=ast.Add(), left=left, right=right):
            found = dict(_joined(sources, source, function, [left, right], depth))
        case ast.List(elts=items) | ast.Tuple(elts=items):
            pairs = (isinstance(item, (ast.Tuple, ast.List)) and item.elts for item in items)
            for first in (pair[0] if pair else item for item, pair in zip(items, pairs, strict=True)):
                found |= names_given(sources, source, function, first, depth - 1)
        case ast.Attribute(attr=name):
            for given in _kept(sources, ast.unparse(node), name):
                found |= names_given(sources, source, function, given, depth - 1)
        case ast.Name():
            found = {**_of_variable(sources, source, function, node, depth)}
    return found


def _of_variable(
    sources: NodeSources, source: PythonSource, function: Function | None, node: ast.Name, depth: int
) -> Names:
    """Return the names that a variable may hold: what it is bound to, and what callers pass for it."""
    found: dict[str, tuple[PythonSource, ast.expr]] = {}
    for number, given in bound_to(source, function, node.id):
        held = sources.value(source, given)
        firsts = first_texts(held, number) if isinstance(held, (list, dict)) else ()
        found |= dict.fromkeys(firsts, (source, node))
        if number is None:
            found |= names_given(sources, source, function, given, depth - 1)
    if function and node.id in [parameter.arg for parameter in parameters(function)]:
        found |= _of_callers(sources, function, node.id, depth)
    return found


def _kept(sources: NodeSources, text: str, name: str) -> Iterator[ast.expr]:
    """Yield the values assigned to an attribute such as `self.name`, also in the body of a class."""
    for node in (node for source in sources.sources.values() for node in source.nodes):
        match node:
            case ast.Assign(targets=[ast.Attribute() as target], value=value) if ast.unparse(target) == text:
                yield value
            case ast.ClassDef(body=body):
                yield from (
                    statement.value
                    for statement in body
                    if isinstance(statement, ast.Assign)
                    and [name] == [getattr(n, "id", "") for n in statement.targets]
                )


def first_texts(items: Any, number: int | None = 0) -> Iterator[str]:
    """Yield the strings among some items, and from each item that is a list the string at the given index."""
    for item in items:
        if isinstance(item, list):
            yield from (text for text in item[number or 0 :][:1] if isinstance(text, str))
        elif isinstance(item, str) and not number:
            yield item


def _joined(
    sources: NodeSources, source: PythonSource, function: Function | None, parts: list[ast.expr], depth: int
) -> Iterator[tuple[str, tuple[PythonSource, ast.expr]]]:
    """Yield the texts that parts may form when joined, each with its origin, a call if there is one."""
    rows = [names_given(sources, source, function, part, depth - 1).items() for part in parts]
    for way in itertools.islice(itertools.product(*rows), 100):
        given = [place for _, place in way]
        yield (
            "".join(text for text, _ in way),
            next((p for p in given if isinstance(p[1], ast.Call)), given[0]),
        )


def bound_to(
    source: PythonSource, function: Function | None, name: str
) -> Iterator[tuple[int | None, ast.expr]]:
    """Yield what a name is bound to: None and an expression, or an index into each item of an expression."""
    for value, path in bindings(own_nodes(function) if function else source.tree.body, name):
        match value:
            case _ if path == ():
                yield None, value
            case ast.Call(func=ast.Attribute(value=held, attr="items" | "keys")) if path[0] is None:
                yield (path[1:] or (0,))[0], held
            case _ if path[0] is None:
                yield (path[1:] or (0,))[0], value


def _of_callers(sources: NodeSources, function: Function, name: str, depth: int) -> Names:
    """Return the names that callers pass for a parameter of a function."""
    found: dict[str, tuple[PythonSource, ast.expr]] = {}
    for home, around, call in calls_of(sources, function):
        given = argument_of(function, call, name)
        texts = names_given(sources, home, around, given, depth - 1) if given is not None else ()
        found |= dict.fromkeys(texts, (home, call))
    return found


def calls_of(
    sources: NodeSources, function: Function
) -> Iterator[tuple[PythonSource, Function | None, ast.Call]]:
    """Yield the calls of a function, found by its name, each with its file and the function around it."""
    for source in sources.sources.values():
        for _, around, call in sources.scoped(source):
            called = call.func if isinstance(call, ast.Call) else None
            is_named = last_name(called) == function.name
            if isinstance(call, ast.Call) and is_named:
                yield source, around, call


def argument_of(function: Function, call: ast.Call, name: str) -> ast.expr | None:
    """Return what a call passes for a parameter of a function; the default if it passes nothing."""
    names = [parameter.arg for parameter in parameters(function)]
    is_method = bool(names) and names[0] in ("self", "cls")
    return by_parameter(call, names[is_method:]).get(name) or defaults_of(function).get(name)
