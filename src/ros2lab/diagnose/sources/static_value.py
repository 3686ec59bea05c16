"""Evaluate a Python expression as far as possible without running anything."""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Final

Calls = Mapping[str, Callable[..., Any]]


class Unknown:
    """The type of `UNKNOWN`, the value of what only running the program would tell."""

    def __repr__(self) -> str:
        return "UNKNOWN"


UNKNOWN: Final = Unknown()

_METHODS: Mapping[type, frozenset[str]] = {
    str: frozenset(
        ("format", "join", "replace", "strip", "lower", "upper", "split", "rstrip", "lstrip", "title")
    ),
    dict: frozenset(("items", "keys", "values", "get")),
}
_ARITHMETIC: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
}
COMPARISONS: Mapping[type[ast.AST], Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    # Of constants, those that are equal are the same object.
    ast.Is: lambda left, right: type(left) is type(right) and left == right,
    ast.IsNot: lambda left, right: type(left) is not type(right) or left != right,
    ast.In: lambda item, items: item in items,
    ast.NotIn: lambda item, items: item not in items,
}
# No float holds a larger integer, and Python refuses to print one with a few more digits.
LARGEST = 2**1023
_LONGEST = 10_000  # items or characters, so that `"x" * 10**9` costs nothing


class _CannotTellError(Exception):
    pass


def evaluate(node: ast.expr | None, names: Mapping[str, Any], calls: Calls) -> Any:
    """Return the value of an expression.

    Args:
        node: the expression.
        names: the values of the known names, including dotted names such as `os.sep`.
        calls: the known functions by their dotted names.

    Returns:
        The value, or `UNKNOWN`; a list, tuple or dict may contain `UNKNOWN`.
    """
    try:
        return bounded(_value(node, names, calls)) if node is not None else UNKNOWN
    except Exception:
        # Whatever a wrong expression raises (a key, a type, a format), its value is not known.
        return UNKNOWN


def expression(text: str) -> ast.expr | None:
    """Return the parsed expression in a text; None if the text is not an expression."""
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    bound(ast.walk(tree))
    return tree.body


def bound(nodes: Iterable[ast.AST]) -> None:
    """Limit all integers among some nodes to `LARGEST`."""
    for node in nodes:
        if isinstance(node, ast.Constant):
            node.value = bounded(node.value)


def bounded(value: Any) -> Any:
    """Return a value, an integer limited to `LARGEST`."""
    return max(-LARGEST, min(value, LARGEST)) if type(value) is int else value


def dotted(node: ast.AST | None) -> str | None:
    """Return an expression as a dotted name such as `os.path.join`; None if it is not one."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        before = dotted(node.value)
        return f"{before}.{node.attr}" if before else None
    return None


def is_known(value: Any) -> bool:
    """Return whether a value is known, and everything in it."""
    if isinstance(value, (list, tuple, set)):
        return all(is_known(item) for item in value)
    if isinstance(value, dict):
        return all(is_known(item) for pair in value.items() for item in pair)
    return value is not UNKNOWN


def _value(node: ast.expr, names: Mapping[str, Any], calls: Calls) -> Any:  # noqa: PLR0911 -- a table
    def part(inner: ast.expr) -> Any:
        return evaluate(inner, names, calls)

    def sure(inner: ast.expr) -> Any:
        return _sure(part(inner))

    match node:
        case ast.Constant():
            return node.value
        case ast.Name() | ast.Attribute() if dotted(node) in names:
            return names[str(dotted(node))]
        case ast.JoinedStr():
            return "".join(str(sure(piece)) for piece in node.values)
        case ast.FormattedValue(conversion=-1, format_spec=None):
            return sure(node.value)
        case ast.List() | ast.Tuple() | ast.Set():
            return _items(node.elts, part)
        case ast.Dict():
            return _pairs(node, part)
        case ast.ListComp() | ast.GeneratorExp() | ast.SetComp():
            return [evaluate(node.elt, scope, calls) for scope in _scopes(node.generators, names, calls)]
        case ast.DictComp():
            return {
                evaluate(node.key, scope, calls): evaluate(node.value, scope, calls)
                for scope in _scopes(node.generators, names, calls)
            }
        case ast.Call():
            return _called(node, part, sure, calls)
    return _operation(node, part, sure)


def _operation(  # noqa: PLR0911 -- a table
    node: ast.expr, part: Callable[[ast.expr], Any], sure: Callable[[ast.expr], Any]
) -> Any:
    match node:
        case ast.BinOp():
            return _joined(node, part)
        case ast.UnaryOp(op=ast.USub()):
            return -sure(node.operand)
        case ast.UnaryOp(op=ast.Not()):
            return not sure(node.operand)
        case ast.BoolOp():
            return _either(node, sure)
        case ast.Compare():
            return _compared(node, sure)
        case ast.Subscript():
            return sure(node.value)[sure(node.slice)]
        case ast.IfExp():
            return part(node.body) if sure(node.test) else part(node.orelse)
    return UNKNOWN


def _either(node: ast.BoolOp, sure: Callable[[ast.expr], Any]) -> Any:
    """Return the value of `and` or `or`: that of the side that decides."""
    value: Any = None
    for value in map(sure, node.values):
        if bool(value) is isinstance(node.op, ast.Or):
            break
    return value


def _compared(node: ast.Compare, sure: Callable[[ast.expr], Any]) -> Any:
    sides = (node.left, *node.comparators)
    is_same = any(isinstance(sign, (ast.Is, ast.IsNot)) for sign in node.ops)
    if is_same and not all(isinstance(side, (ast.Constant, ast.Name, ast.Attribute)) for side in sides):
        return UNKNOWN  # what has been computed may be another object
    values = [*map(sure, sides)]
    pairs = zip(values, node.ops, values[1:], strict=False)
    return all(COMPARISONS[type(sign)](left, right) for left, sign, right in pairs)


def _joined(node: ast.BinOp, part: Callable[[ast.expr], Any]) -> Any:
    # Evaluate each side only once: twice would take for ever in a sum of thirty terms.
    left, right = part(node.left), part(node.right)
    if isinstance(node.op, ast.Add):
        are_lists = isinstance(left, (list, tuple)) and isinstance(right, (list, tuple))
        return [*left, *right] if are_lists else _short(_sure(left) + _sure(right))
    if isinstance(node.op, ast.Mod) and isinstance(left, str):
        return _short(_plain(left) % _sure(right))
    numbers = all(isinstance(side, (int, float)) for side in (left, right))
    return _ARITHMETIC[type(node.op)](left, right) if numbers and type(node.op) in _ARITHMETIC else UNKNOWN


def _sure(value: Any) -> Any:
    """Return a value if all of it is known."""
    if not is_known(value):
        raise _CannotTellError
    return value


def _items(elements: list[ast.expr], part: Callable[[ast.expr], Any]) -> list[Any]:
    found: list[Any] = []
    for element in elements:
        value = part(element.value if isinstance(element, ast.Starred) else element)
        if isinstance(element, ast.Starred) and isinstance(value, (list, tuple)):
            found.extend(value)
        else:
            found.append(value)
    return found


def _pairs(node: ast.Dict, part: Callable[[ast.expr], Any]) -> Any:
    found: dict[Any, Any] = {}
    for key, inner in zip(node.keys, node.values, strict=True):
        value = part(inner)
        if key is not None:
            found[part(key)] = value
        elif isinstance(value, dict):
            found.update(value)
        else:
            return UNKNOWN
    return found


def _scopes(
    generators: list[ast.comprehension], names: Mapping[str, Any], calls: Calls
) -> list[Mapping[str, Any]]:
    scopes: list[Mapping[str, Any]] = [names]
    for generator in generators:
        inner = []
        for scope in scopes:
            items = evaluate(generator.iter, scope, calls)
            if items is UNKNOWN:
                raise _CannotTellError
            for item in list(items)[:_LONGEST]:
                bound = {**scope, **_bound(generator.target, item)}
                tests = [evaluate(test, bound, calls) for test in generator.ifs]
                if UNKNOWN in tests:
                    raise _CannotTellError
                if all(tests):
                    inner.append(bound)
                if len(inner) > _LONGEST:
                    raise _CannotTellError
        scopes = list(inner)
    return scopes


def _bound(target: ast.expr, value: Any) -> dict[str, Any]:
    if isinstance(target, ast.Name):
        return {target.id: value}
    if isinstance(target, (ast.Tuple, ast.List)):
        return {
            name: inner
            for element, item in zip(target.elts, value, strict=True)
            for name, inner in _bound(element, item).items()
        }
    raise _CannotTellError


def _called(
    node: ast.Call, part: Callable[[ast.expr], Any], sure: Callable[[ast.expr], Any], calls: Calls
) -> Any:
    if any(isinstance(argument, ast.Starred) for argument in node.args):
        return UNKNOWN
    arguments = [part(argument) for argument in node.args]
    keywords = {keyword.arg or "": part(keyword.value) for keyword in node.keywords}
    name = dotted(node.func)
    if name is not None and name in calls:
        return calls[name](*arguments, **keywords)
    if not isinstance(node.func, ast.Attribute):
        return UNKNOWN
    owner = sure(node.func.value)
    if node.func.attr in _METHODS.get(type(owner), ()) and is_known(arguments) and is_known(keywords):
        value = getattr(_plain(owner), node.func.attr)(*arguments, **keywords)
        return _short(value) if isinstance(value, str) else value
    return UNKNOWN


def _short(value: Any) -> Any:
    if isinstance(value, str) and len(value) > _LONGEST:
        raise _CannotTellError
    return value


def _plain(value: Any) -> Any:
    """Return a value, or give up if it is a format string with a huge field width."""
    if isinstance(value, str) and re.search(r"[%{:].*\d{4}", value):
        raise _CannotTellError
    return value


def holds(test: ast.expr, names: Mapping[str, Any]) -> bool | None:
    """Return whether a condition is true where names have these values; None if that is not known."""
    value = evaluate(test, names, {})
    return None if value is UNKNOWN else bool(value)
