"""The calls and assignments among syntax nodes, what fills the parameters of a function, and how to remove a statement."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence

from ros2lab.diagnose.sources.python_source import Function, PythonSource, parameters


def calls_in(nodes: Iterable[ast.AST]) -> list[ast.Call]:
    """Return the calls among some nodes."""
    return [node for node in nodes if isinstance(node, ast.Call)]


def calls_of(nodes: Iterable[ast.AST], *methods: str) -> list[ast.Call]:
    """Return the calls among some nodes of methods, or functions of modules, with one of some names."""
    return [call for call in calls_in(nodes) if getattr(call.func, "attr", "") in methods]


def stores_in(nodes: Iterable[ast.AST]) -> Iterator[ast.Name | ast.Attribute]:
    """Yield the names and attributes among some nodes that are assigned to."""
    for node in nodes:
        if isinstance(node, (ast.Name, ast.Attribute)) and isinstance(node.ctx, ast.Store):
            yield node


ADDS = frozenset(("append", "appendleft", "insert", "extend", "add"))
TAKES_OUT = frozenset(("remove", "pop", "popleft", "discard", "popitem", "clear"))
# Methods that put other items into a collection; an order may be made anew each time.
CHANGES = ADDS | TAKES_OUT | {"update", "setdefault"}


def changed_by(node: ast.AST) -> ast.expr | None:
    """Return the collection that a node changes in place: by a method, or by setting or deleting an item; None if none."""
    match node:
        case ast.Call(func=ast.Attribute(value=holder, attr=attr)) if attr in CHANGES:
            return holder
        case ast.Subscript(value=holder, ctx=ast.Store() | ast.Del()):
            return holder
    return None


def makes_text(value: ast.expr) -> bool:
    """Return whether an expression puts a text together."""
    match value:
        case ast.JoinedStr() | ast.Call(func=ast.Name(id="str") | ast.Attribute(attr="format")):
            return True
        case ast.BinOp(left=left, right=right):
            return any(makes_text(n) or isinstance(getattr(n, "value", None), str) for n in (left, right))
    return False


def all_parameters(function: Function | ast.Lambda) -> list[ast.arg]:
    """Return a function's parameters, also those that are only given by keyword."""
    return [*parameters(function), *function.args.kwonlyargs]


def is_property(function: Function) -> bool:
    """Return whether a function is a property: `@property`, `@cached_property`, a getter or a setter."""
    names = [ast.unparse(decorator).rpartition(".")[2] for decorator in function.decorator_list]
    return any("property" in name or name in ("getter", "setter", "deleter") for name in names)


def own_parameters(function: Function) -> list[ast.arg]:
    """Return a function's positional parameters without self."""
    return [parameter for parameter in parameters(function) if parameter.arg not in ("self", "cls")]


def defaults_of(function: Function) -> dict[str, ast.expr]:
    """Return the default values of a function's parameters by their names."""
    names = [parameter.arg for parameter in parameters(function)]
    found = dict(zip(reversed(names), reversed(function.args.defaults), strict=False))
    keywords = zip(function.args.kwonlyargs, function.args.kw_defaults, strict=True)
    return found | {parameter.arg: default for parameter, default in keywords if default is not None}


def needed_by(function: Function | ast.Lambda) -> list[str]:
    """Return the positional parameters without defaults of a function, without `self`."""
    names = [parameter.arg for parameter in parameters(function)]
    names = names[: len(names) - len(function.args.defaults)]
    return names[1:] if names[:1] in (["self"], ["cls"]) else names


def by_parameter(call: ast.Call, names: Sequence[str]) -> dict[str, ast.expr]:
    """Return what a call passes, by the names of the parameters in their order."""
    given = dict(zip(names, call.args, strict=False))
    return given | {keyword.arg: keyword.value for keyword in call.keywords if keyword.arg}


def equal_sides(node: ast.Compare) -> Iterator[tuple[ast.expr, list[ast.expr], bool]]:
    """Yield each side of a comparison by == or in with the values on the other, and whether it asks for equality."""
    for left, how, right in zip([node.left, *node.comparators], node.ops, node.comparators, strict=False):
        is_equal = isinstance(how, (ast.Eq, ast.In))
        if isinstance(how, (ast.Eq, ast.NotEq)):
            yield left, [right], is_equal
            yield right, [left], is_equal
        elif isinstance(how, (ast.In, ast.NotIn)) and isinstance(right, (ast.Tuple, ast.List, ast.Set)):
            yield left, right.elts, is_equal


LEFT_OUT = "..."  # an argument with this new text is left out


def with_arguments(call: ast.Call, new: Mapping[int, str]) -> str:
    """Return a call with other texts for some of its arguments, by their `id`."""
    places = [
        new.get(id(value)) or ast.unparse(value) for value in call.args if new.get(id(value)) != LEFT_OUT
    ]
    pairs = (
        (keyword.arg, new.get(id(keyword.value)) or ast.unparse(keyword.value)) for keyword in call.keywords
    )
    named = [f"{name}={text}" if name else f"**{text}" for name, text in pairs if text != LEFT_OUT]
    return f"{ast.unparse(call.func)}({', '.join([*places, *named])})"


_BLOCKS = ("body", "orelse", "finalbody")


def removal(source: PythonSource, node: ast.AST, what: str = "") -> str:
    """Return how to remove a statement, called `what`: a loop goes with its only line, and another block keeps a `pass`."""
    above = source.above(node)
    statement = above if isinstance(above, ast.Expr) else node
    what = what or f"`{ast.unparse(node)}`"
    while isinstance(loop := _left_empty(source, statement), (ast.For, ast.While)):
        if loop.orelse:
            break
        statement, what = loop, f"the whole loop `{ast.unparse(loop).splitlines()[0]}`"
    return f"write `pass` instead of {what}" if loop else f"remove {what}"


def _left_empty(source: PythonSource, statement: ast.AST) -> ast.AST | None:
    """Return what has a block in which a statement is alone; None if it is not alone."""
    for node in source.nodes:
        if any(getattr(node, name, None) == [statement] for name in _BLOCKS):
            return None if isinstance(node, ast.Module) else node
    return None
