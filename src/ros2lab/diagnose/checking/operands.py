"""Fixes for operators with a value that holds the intended number, such as a parameter or a message."""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence

from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces

_SIGNS: dict[type[ast.AST], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Mod: "%", ast.FloorDiv: "//", ast.Pow: "**",
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
}  # fmt: skip


_NUMBER = re.compile(r"(?:int|float)\b|Literal\[[-\d]")  # as Python and as the type checker name it


def unwrapped(spot: Spot, kinds: Sequence[str], sign: str) -> str:
    """Say how to join or compare two values if one of them holds the intended number; else empty.

    Args:
        spot: the line with the operator.
        kinds: the types of the two values.
        sign: the operator; empty for any.
    """
    for node in spot.nodes:
        match node:
            case ast.BinOp(left=left, op=operator, right=right):
                pass
            case ast.Compare(left=left, ops=[operator], comparators=[right]):
                pass
            case ast.AugAssign(target=left, op=operator, value=right):
                pass
            case _:
                continue
        between = _SIGNS.get(type(operator), "")
        between += "=" * isinstance(node, ast.AugAssign)
        if sign not in ("", between):
            continue
        if "Time" in kinds and sign in ("+", "-") and (number := _number_of(kinds, (left, right))):
            # Only a duration can be added to a point in time.
            made = f"Duration(seconds={ast.unparse(number)})"
            texts = [made if side is number else ast.unparse(side) for side in (left, right)]
            return (
                f"write `{f' {between} '.join(texts)}`, with `from rclpy.duration import Duration` at the top"
            )
        texts = [_held(side, kind) for side, kind in zip((left, right), kinds, strict=True)]
        texts = [_as_number(side, kinds) or text for side, text in zip((left, right), texts, strict=True)]
        if texts != [ast.unparse(left), ast.unparse(right)]:
            return f"write `{f' {between} '.join(texts)}`"
    return ""


def _as_number(side: ast.expr, kinds: Sequence[str]) -> str:
    """Return a quoted number without its quotes if the other operand is a number; else empty."""
    is_text = isinstance(side, ast.Constant) and isinstance(side.value, str)
    text = str(side.value).strip() if is_text else ""  # type: ignore[attr-defined]
    is_beside_number = any(map(_NUMBER.match, kinds))
    return text if is_beside_number and re.fullmatch(r"[-+]?\d+(\.\d*)?", text) else ""


def _number_of(kinds: Sequence[str], sides: Sequence[ast.expr]) -> ast.expr | None:
    numbers = (side for kind, side in zip(kinds, sides, strict=True) if _NUMBER.match(kind))
    return next(numbers, None)


def _held(value: ast.expr, kind: str) -> str:
    """Return the expression for the value inside a parameter, a message or a time; others unchanged."""
    text = ast.unparse(value)
    whole = text if isinstance(value, (ast.Name, ast.Attribute, ast.Call)) else f"({text})"
    return held_in(whole, kind) or text


def held_in(text: str, kind: str) -> str:
    """Return the expression for the value inside a parameter, a one-field message or a time; else empty.

    Args:
        text: the expression.
        kind: the name of its class.
    """
    if kind == "Parameter":
        return f"{text}.value"
    if field := interfaces.only_field(kind):
        return f"{text}.{field}"
    is_time = any("nanoseconds" in interfaces.members_of(home, kind)[0] for home in _times(kind))
    return f"{text}.nanoseconds / 1e9" if is_time else ""


def _times(kind: str) -> list[str]:
    return [home for home in interfaces.homes_of(kind) if home.startswith("rclpy.")]


def as_template(spot: Spot) -> str:
    """Return the Python call for one that was written with < and >, as in C++; empty if there is none."""
    for node in spot.nodes:
        match node:
            case ast.Compare(left=function, ops=[ast.Lt(), ast.Gt()], comparators=[kind, given]):
                rest = given.elts if isinstance(given, ast.Tuple) else [given]
                return f"{ast.unparse(function)}({', '.join(map(ast.unparse, [kind, *rest]))})"
    return ""
