"""The value of an expression in a single case, in which each name and attribute in it has a known value."""

from __future__ import annotations

import ast
import functools
import itertools
import math
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ros2lab.diagnose.sources.interfaces import is_interface
from ros2lab.diagnose.sources.python_source import children
from ros2lab.diagnose.sources.static_value import COMPARISONS, UNKNOWN
from ros2lab.grading.code.ranges import Numbers, Range, of_kind, of_value

ARITHMETIC: Mapping[type[ast.AST], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}
_CONVERSIONS: Mapping[str, Callable[[Any], Any]] = {"float": float, "int": int, "bool": bool, "abs": abs}
COMPUTED = (ast.BinOp, ast.UnaryOp, ast.Subscript, ast.Call)  # what a range may be known of
_LARGEST = 1e15  # the largest number to compute with


@dataclass(frozen=True)
class Given:
    """A value that is not known before the code runs.

    Attributes:
        kind: the type of a message or of a field of one, or `string`; empty if that is not known either.
        within: what it may be of all that the type could hold; None if that is not known.
    """

    kind: str = ""
    within: Range | None = None


@dataclass(frozen=True)
class Member:
    """A member of an enumeration, which differs from all others."""

    name: str


class _FailsError(Exception):
    """The expression raises an error, so that no branch that depends on it is taken."""


FAILS = _FailsError()  # the value of such an expression


class _Other:
    """A value that is not empty and differs from all that the code names."""


Case = Mapping[str, Any]  # the value of each leaf of an expression, by its source text


@functools.lru_cache(maxsize=10_000)  # each part of a long sum is asked for dozens of times
def text_of(node: ast.AST) -> str:
    """Return the source text of a node; a unique label if Python cannot write it for a long number."""
    try:
        return ast.unparse(node)
    except ValueError:
        return f"#{id(node)}"


def is_leaf(expression: ast.AST) -> bool:
    """Return whether an expression is a name, an attribute or a call, and no conversion such as `bool(…)`."""
    match expression:
        case ast.Call(func=ast.Name(id=name), args=[_], keywords=[]) if name in _CONVERSIONS:
            return False
        case ast.Name(ctx=ast.Load()) | ast.Attribute(ctx=ast.Load()) | ast.Call():
            return True
    return False


def leaves(expression: ast.AST) -> Iterator[ast.expr]:
    """Yield the names, attributes and calls that an expression is made of."""
    match expression:
        case ast.expr() if is_leaf(expression):
            yield expression
        case ast.Call(args=[inner]):
            yield from leaves(inner)
        case ast.Lambda() | ast.ListComp() | ast.SetComp() | ast.DictComp() | ast.GeneratorExp():
            return
        case _:
            for part in children(expression):
                yield from leaves(part)


def samples(value: Any, constants: Iterable[Any] | None) -> list[Any]:
    """Return samples of all that a value may be.

    Args:
        value: a known value, or `Given`.
        constants: all that it is compared with; None if it is used in another way, too, so that nothing is
            known.
    """
    if not isinstance(value, Given):
        return [value]
    if value.kind == "boolean":
        return [True, False]
    if constants is None:
        return [UNKNOWN]
    known = [*_flat(constants)]
    named = [constant for constant in known if isinstance(constant, str)]
    texts = ["", "\0", *named, *(["".join(named)] if len(named) > 1 else [])]
    within = value.within or of_kind(value.kind)
    numbers = _numbers(known, within)
    if within is not None:
        found: list[Any] = [*texts, *numbers, math.nan, math.inf, -math.inf]
        is_whole = isinstance(within, Numbers) and within.is_whole
        return [int(held) if is_whole else held for held in found if within.holds(held)]
    if is_interface(value.kind):
        return [_Other()]
    return [None, True, False, _Other(), *numbers, *texts, *known]


def _numbers(known: Iterable[Any], within: Range | None) -> list[float]:
    """Return numbers that are told apart by known ones: these, some between them, and some on either side."""
    ends = [within.low, within.high] if isinstance(within, Numbers) else []
    given = {
        float(constant)
        for constant in (0, *ends, *known)
        if isinstance(constant, (int, float)) and abs(constant) < _LARGEST
    }
    numbers = sorted(given)
    between = [(low + high) / 2 for low, high in itertools.pairwise(numbers)]
    whole = {
        float(beside) for number in numbers for beside in (math.floor(number) + 1, math.ceil(number) - 1)
    }
    return sorted({*numbers, *between, *whole})


def _flat(constants: Iterable[Any]) -> Iterator[Any]:
    for constant in constants:
        yield from (_flat(constant) if isinstance(constant, (tuple, list, set, frozenset)) else [constant])


def value_of(expression: ast.expr, case: Case) -> Any:
    """Return the value of an expression; `UNKNOWN` or `Given` if not known, `FAILS` if it raises an error."""
    try:
        return _value(expression, case)
    except _FailsError:
        return FAILS
    except Exception:  # whatever a wrong expression raises, its value is not known
        return UNKNOWN


def _value(node: ast.expr, case: Case) -> Any:  # noqa: PLR0911 -- a table
    if case and isinstance(node, COMPUTED) and (text := text_of(node)) in case:
        return case[text]
    match node:
        case ast.Constant(value=known):
            return known
        case ast.Call(func=ast.Name(id=name), args=[inner], keywords=[]) if name in _CONVERSIONS:
            known = _sure(inner, case)
            return math.nan if (found := _CONVERSIONS[name](known)) != found else found
        case ast.Name() | ast.Attribute() | ast.Call():
            return case.get(text_of(node), UNKNOWN)
        case ast.UnaryOp(op=ast.Not(), operand=inner):
            return not _sure(inner, case)
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return -_sure(inner, case)
        case ast.BoolOp(op=sign, values=parts):
            return _joined(isinstance(sign, ast.Or), parts, case)
        case ast.Compare():
            return _compared(node, case)
        case ast.BinOp():
            return _computed(node, case)
        case ast.JoinedStr():
            return Given("string")
        case ast.Tuple(elts=parts) | ast.List(elts=parts) | ast.Set(elts=parts):
            values = [value_of(part, case) for part in parts]
            return tuple(Given() if value is UNKNOWN else value for value in values)
        case ast.IfExp(test=test, body=body, orelse=orelse):
            return _value(body if _sure(test, case) else orelse, case)
    return UNKNOWN


def _sure(node: ast.expr, case: Case) -> Any:
    value = _value(node, case)
    if value is FAILS:
        raise _FailsError
    if value is UNKNOWN or isinstance(value, Given):
        raise ValueError
    return value


def _joined(decides: bool, parts: Iterable[ast.expr], case: Case) -> Any:
    """Return the value of an `or`, which True `decides`, or of an `and`, which False does."""
    value: Any = not decides
    is_known = True
    for part in parts:
        value = value_of(part, case)
        if value is UNKNOWN or isinstance(value, Given):
            is_known = False
        elif value is FAILS:
            return FAILS if is_known else UNKNOWN
        elif bool(value) is decides:
            return value
    return value if is_known else UNKNOWN


def _compared(node: ast.Compare, case: Case) -> Any:
    sides = [node.left, *node.comparators]
    results = list[Any]()
    for sign, (left, right) in zip(node.ops, itertools.pairwise(sides), strict=True):
        values = [value_of(side, case) for side in (left, right)]
        if FAILS in values:
            return FAILS
        is_known = not any(value is UNKNOWN or isinstance(value, Given) for value in values)
        try:
            results.append(bool(COMPARISONS[type(sign)](*values)) if is_known else UNKNOWN)
        except TypeError:
            return FAILS
    return False if False in results else UNKNOWN if UNKNOWN in results else True


def _computed(node: ast.BinOp, case: Case) -> Any:
    left, right = value_of(node.left, case), value_of(node.right, case)
    is_left, is_right = (
        isinstance(side, str) or getattr(side, "kind", "") == "string" for side in (left, right)
    )
    match node.op:
        case ast.Add() if is_left or is_right:
            return Given("string")
        case ast.Mod() | ast.Mult() if is_left:
            return Given("string")
    return changed(left, node.op, right)


def changed(left: Any, sign: ast.operator, right: Any) -> Any:
    """Return the result of an operation on two numbers; `UNKNOWN` for anything else."""
    are_numbers = all(isinstance(side, (int, float)) and abs(side) < _LARGEST for side in (left, right))
    return ARITHMETIC[type(sign)](left, right) if are_numbers and type(sign) in ARITHMETIC else UNKNOWN


def plain(value: Any) -> Any:
    """Return a value as it can stand in a set: lists as tuples."""
    return tuple(map(plain, value)) if isinstance(value, (tuple, list)) else value


def is_truth(expression: ast.expr) -> bool:
    """Return whether an expression is true or false, whatever it is made of."""
    match expression:
        case ast.Compare() | ast.UnaryOp(op=ast.Not()):
            return True
        case ast.BoolOp(values=parts):
            return all(map(is_truth, parts))
    return False


def range_within(value: Any) -> Range | None:
    """Return the range in which a value is; None if it is neither a number nor a text."""
    return (value.within or of_kind(value.kind)) if isinstance(value, Given) else of_value(value)


def parted(value: Any) -> tuple[Any, ...]:
    """Return the values that a value stands for: both truth values for a `Given` boolean, else itself."""
    return (True, False) if value == Given("boolean") else (value,)
