"""Fixes for operators with a value that holds the intended number, such as a parameter or a message."""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence

from ros2lab.diagnose.code.placeholders import regrouped
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.joined_texts import text_of
from ros2lab.diagnose.sources.kinds import kind_within
from ros2lab.diagnose.sources.node_source import is_self_attribute
from ros2lab.diagnose.sources.python_source import last_name

_SIGNS: dict[type[ast.AST], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Mod: "%", ast.FloorDiv: "//", ast.Pow: "**",
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
}  # fmt: skip


_NUMBER = re.compile(r"(?:int|float)\b|Literal\[[-\d]")  # as Python and as the type checker name it


def unwrapped(spot: Spot, kinds: Sequence[str], sign: str) -> str:
    """Say how to join or compare two values of some types by a sign, any if empty, if one holds the intended number; else empty."""
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
        if regrouped(node) and _NUMBER.match(kinds[1]):
            return f"write `{regrouped(node)}` instead of `{ast.unparse(node)}`"
        if as_sent := _from_messages(spot, (left, right), kinds):
            return f"write `{f' {between} '.join(as_sent[0])}`{as_sent[1]}"
        numbers = [side for kind, side in zip(kinds, (left, right), strict=True) if _NUMBER.match(kind)]
        if "Time" in kinds and sign in ("+", "-") and numbers:
            # Only a duration can be added to a point in time.
            made = f"Duration(seconds={ast.unparse(numbers[0])})"
            texts = [made if side is numbers[0] else ast.unparse(side) for side in (left, right)]
            return (
                f"write `{f' {between} '.join(texts)}`, with `from rclpy.duration import Duration` at the top"
            )
        texts = [_held(side, kind) for side, kind in zip((left, right), kinds, strict=True)]
        texts = [_as_number(side, kinds) or text for side, text in zip((left, right), texts, strict=True)]
        if texts != [ast.unparse(left), ast.unparse(right)]:
            return f"write `{f' {between} '.join(texts)}`"
    return ""


def _from_messages(
    spot: Spot, sides: Sequence[ast.expr], kinds: Sequence[str]
) -> tuple[list[str], str] | None:
    """Return the sides with times that are messages made ones of rclpy, and the imports; None if none of them is known to be.

    A number is compared with their seconds. Of two times that Python cannot join, one is a message.
    """
    found: list[bool | None] = [_is_sent(spot, side) for side in sides]
    names = [kind.rpartition(".")[2] for kind in kinds]
    if not {"Time", "Duration"}.isdisjoint(names) and False in found:
        found = [is_sent is not False for is_sent in found]
    texts, more = [*map(ast.unparse, sides)], dict[str, None]()
    for number, (kind, is_sent) in enumerate(zip(names, found, strict=True)):
        if is_sent and kind in ("Time", "Duration"):
            home = f"rclpy.{kind.lower()}"
            is_taken = spot.file.names.get(kind, f"{home}.{kind}") != f"{home}.{kind}"
            seconds = ".nanoseconds / 1e9" * bool(_NUMBER.match(kinds[1 - number]))
            texts[number] = f"{f'{home}.' * is_taken}{kind}.from_msg({texts[number]}){seconds}"
            more[f", with `{f'import {home}' if is_taken else f'from {home} import {kind}'}` at the top"] = (
                None
            )
    return (texts, "".join(more)) if more else None


def _is_sent(spot: Spot, side: ast.expr) -> bool | None:
    """Return whether a value is a message of a time, and none of rclpy; None if that is not known."""
    kind = kind_within(spot.file, side) or ""
    for value in (side, *spot.assigned(ast.unparse(side))):
        name = last_name(value.func) if isinstance(value, ast.Call) else ""
        kind = kind_within(spot.file, value) or kind
        if name in ("now", "from_msg") or (spot.file.resolve(getattr(value, "func", None)) or "").startswith(
            "rclpy."
        ):
            return False
    is_field = isinstance(side, ast.Attribute) and side.attr == "stamp" and not is_self_attribute(side)
    return True if is_field or kind.startswith("builtin_interfaces.msg.") else None


def _as_number(side: ast.expr, kinds: Sequence[str]) -> str:
    """Return a quoted number without its quotes if the other operand is a number; else empty."""
    text = text_of(side).strip()
    is_beside_number = any(map(_NUMBER.match, kinds))
    return text if is_beside_number and re.fullmatch(r"[-+]?\d+(\.\d*)?", text) else ""


def _held(value: ast.expr, kind: str) -> str:
    """Return the expression for the value inside a parameter, a message or a time; others unchanged."""
    text = ast.unparse(value)
    whole = text if isinstance(value, (ast.Name, ast.Attribute, ast.Call)) else f"({text})"
    return held_in(whole, kind) or text


def held_in(text: str, kind: str) -> str:
    """Return the expression for the value inside a parameter, a one-field message or a time; else empty."""
    if kind == "Parameter":
        return f"{text}.value"
    if field := interfaces.only_field(kind):
        return f"{text}.{field}"
    times = [home for home in interfaces.homes_of(kind) if home.startswith("rclpy.")]
    is_time = any("nanoseconds" in interfaces.members_of(home, kind) for home in times)
    return f"{text}.nanoseconds / 1e9" if is_time else ""


def as_template(spot: Spot) -> str:
    """Return the Python call for one that was written with < and >, as in C++; empty if there is none."""
    for node in spot.nodes:
        match node:
            case ast.Compare(left=function, ops=[ast.Lt(), ast.Gt()], comparators=[kind, given]):
                rest = given.elts if isinstance(given, ast.Tuple) else [given]
                return f"{ast.unparse(function)}({', '.join(map(ast.unparse, [kind, *rest]))})"
    return ""
