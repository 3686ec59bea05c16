"""Which numbers and texts an expression may come to, where what it is computed from is not known.

A square is never below zero, a length neither, and a text in capitals has no small letters. What is not known here
may be anything.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

_WHOLE = re.compile(r"(u?)int(8|16|32|64)")
_SMALL = ("octet", "byte", "char")
_LARGEST = 1e15  # the largest bound that is computed with


@dataclass(frozen=True)
class Numbers:
    """Numbers from a lowest to a highest, and not-a-number if they are no integers.

    Attributes:
        is_whole: whether all of them are integers.
    """

    low: float = -math.inf
    high: float = math.inf
    is_whole: bool = False

    @property
    def kind(self) -> str:
        """The type that a field of a message would have."""
        return "int64" if self.is_whole else "double"

    def holds(self, value: Any) -> bool:
        """Return whether a value is one of them."""
        if not isinstance(value, (int, float)):
            return False
        if not math.isfinite(value):
            return not self.is_whole and (math.isnan(value) or self.low <= value <= self.high)
        return self.low <= value <= self.high and (not self.is_whole or float(value).is_integer())


@dataclass(frozen=True)
class Texts:
    """Texts of at most a length, which a method such as `upper` leaves as they are.

    Attributes:
        kept_by: the method; empty for any text.
    """

    longest: float = math.inf
    kept_by: str = ""
    kind = "string"

    def holds(self, value: Any) -> bool:
        """Return whether a value is one of them."""
        is_kept = isinstance(value, str) and (not self.kept_by or getattr(value, self.kept_by)() == value)
        return is_kept and len(value) <= self.longest


Range = Numbers | Texts
RangeOf = Callable[[ast.expr], Range | None]

_COUNT = Numbers(0, is_whole=True)
_PART = Numbers(-1, 1)
_KEPT = ("upper", "lower", "strip", "lstrip", "rstrip", "casefold")  # done twice, they do no more than once
# What functions come to, whatever numbers they are given.
_OF_NUMBERS = {
    "math.sqrt": Numbers(0),
    "math.hypot": Numbers(0),
    "math.exp": Numbers(0),
    "math.sin": _PART,
    "math.cos": _PART,
    "math.tanh": _PART,
    "math.atan": Numbers(-math.pi / 2, math.pi / 2),
    "math.asin": Numbers(-math.pi / 2, math.pi / 2),
    "math.acos": Numbers(0, math.pi),
    "math.atan2": Numbers(-math.pi, math.pi),
}
_OF_TEXTS = {"count": _COUNT, "find": Numbers(-1, is_whole=True), "rfind": Numbers(-1, is_whole=True)}


def of_kind(kind: str) -> Range | None:
    """Return what a field of a type may hold; None if it is no number or text."""
    if match := _WHOLE.fullmatch(kind):
        bits = int(match[2]) - (not match[1])
        return Numbers(0 if match[1] else -(2**bits), 2**bits - 1, is_whole=True)
    if kind in _SMALL:
        return Numbers(0, 255, is_whole=True)
    if kind in ("float", "double"):
        return Numbers()
    return Texts() if kind.partition("<")[0] in ("string", "wstring") else None


def of_value(value: Any) -> Range | None:
    """Return the range that a known value is in by itself; None if it is neither a number nor a text."""
    if isinstance(value, str):
        return Texts(len(value))
    is_number = type(value) in (int, float) and abs(value) < _LARGEST
    return Numbers(value, value, isinstance(value, int)) if is_number else None


def joined(ranges: Iterable[Range | None]) -> Range | None:
    """Return a range that holds all of some; None if one is not known, or there are numbers and texts."""
    found = [*ranges]
    numbers = [known for known in found if isinstance(known, Numbers)]
    texts = [known for known in found if isinstance(known, Texts)]
    if numbers and len(numbers) == len(found):
        return Numbers(
            min(known.low for known in numbers),
            max(known.high for known in numbers),
            all(known.is_whole for known in numbers),
        )
    if texts and len(texts) == len(found):
        kept = {known.kept_by for known in texts}
        return Texts(max(known.longest for known in texts), kept.pop() if len(kept) == 1 else "")
    return None


def computed(node: ast.expr, name: str, of: RangeOf) -> Range | None:
    """Return the range of an expression that is computed; None if it may come to anything.

    Args:
        node: the expression.
        name: the whole name of the function, if it is a call.
        of: the range of an inner expression.
    """
    match node:
        case ast.BinOp(left=left, op=op, right=right):
            return _joined_by(op, left, right, of)
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            known = of(inner)
            return Numbers(-known.high, -known.low, known.is_whole) if isinstance(known, Numbers) else None
        case ast.Call(args=args, keywords=[]) if not any(isinstance(arg, ast.Starred) for arg in args):
            return _called(node, name, args, of)
        case ast.Subscript(value=text, slice=ast.Slice(lower=None, upper=ast.Constant(value=int(end)))):
            known = of(text)
            return Texts(min(known.longest, end)) if isinstance(known, Texts) and end >= 0 else None
    return None


def is_no_loss(known: Range | None) -> bool:
    """Return whether a number does not get less if something is added to it."""
    return isinstance(known, Numbers) and known.low >= 0


def is_pure(node: ast.expr, name_of: Callable[[ast.expr], str]) -> bool:
    """Return whether an expression comes to the same each time: each call in it is one that is known here."""
    return all(
        name_of(call.func) in (*_OF_NUMBERS, *_PLAIN)
        or getattr(call.func, "attr", "") in (*_KEPT, *_OF_TEXTS)
        for call in ast.walk(node)
        if isinstance(call, ast.Call)
    )


def _called(call: ast.Call, name: str, args: list[ast.expr], of: RangeOf) -> Range | None:
    known = [of(arg) for arg in args]
    if name == "len":
        return Numbers(0, known[0].longest, is_whole=True) if _are(Texts, known) else _COUNT  # type: ignore[union-attr]
    if name in _PLAIN:
        return _PLAIN[name](known) if _are(Numbers, known) else None  # type: ignore[arg-type]
    if name in _OF_NUMBERS:
        return _OF_NUMBERS[name] if _are(Numbers, known) else None
    match call.func:
        case ast.Attribute(value=owner, attr=method) if isinstance(text := of(owner), Texts):
            if method in _KEPT and not args:
                return Texts(text.longest if method.endswith("strip") else math.inf, method)
            return _OF_TEXTS.get(method)
    return None


def _are(kind: type[Range], known: list[Range | None]) -> bool:
    return bool(known) and all(isinstance(found, kind) for found in known)


def _distance(known: list[Numbers]) -> Numbers:
    (only,) = known
    ends = (abs(only.low), abs(only.high))
    return Numbers(0 if only.low <= 0 <= only.high else min(ends), max(ends), only.is_whole)


def _whole(known: list[Numbers]) -> Numbers:
    low, high = (
        end if math.isinf(end) else way(end)
        for end, way in ((known[0].low, math.floor), (known[0].high, math.ceil))
    )
    return Numbers(low, high, is_whole=len(known) == 1)


def _highest(known: list[Numbers]) -> Numbers:
    whole = all(found.is_whole for found in known)
    return Numbers(max(found.low for found in known), max(found.high for found in known), whole)


def _lowest(known: list[Numbers]) -> Numbers:
    whole = all(found.is_whole for found in known)
    return Numbers(min(found.low for found in known), min(found.high for found in known), whole)


_PLAIN: dict[str, Callable[[list[Numbers]], Numbers]] = {
    "abs": _distance,
    "math.fabs": _distance,
    "int": _whole,
    "round": _whole,
    "math.floor": _whole,
    "math.ceil": _whole,
    "float": lambda known: Numbers(known[0].low, known[0].high),
    "max": _highest,
    "min": _lowest,
    "len": lambda _known: _COUNT,
}


def _joined_by(op: ast.operator, left: ast.expr, right: ast.expr, of: RangeOf) -> Range | None:
    first, second = of(left), of(right)
    if isinstance(first, Texts) and isinstance(second, Texts) and isinstance(op, ast.Add):
        return Texts(first.longest + second.longest)
    if not (isinstance(first, Numbers) and isinstance(second, Numbers)):
        return None
    whole = first.is_whole and second.is_whole
    low, high = -math.inf, math.inf
    match op:
        case ast.Add():
            low, high = first.low + second.low, first.high + second.high
        case ast.Sub():
            low, high = first.low - second.high, first.high - second.low
        case ast.Mult():
            ends = [_times(one, two) for one in (first.low, first.high) for two in (second.low, second.high)]
            is_square = ast.dump(left) == ast.dump(right)
            low, high = max(0, min(ends)) if is_square else min(ends), max(ends)
        case ast.Pow() if second.low == second.high and second.low in (2, 4, 6):
            low = 0
        case ast.Mod() if second.low > 0:
            low, high = 0, second.high - whole
        case ast.Div():
            low, whole = 0 if first.low >= 0 and second.low > 0 else low, False
        case ast.Mod() | ast.FloorDiv():
            pass
        case _:
            return None
    return Numbers(low, high, whole)


def _times(one: float, two: float) -> float:
    return 0.0 if 0 in (one, two) else one * two
