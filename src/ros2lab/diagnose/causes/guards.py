"""How what follows in a function is left out while a value is not there."""

from __future__ import annotations

import ast

from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.own_functions import returned


def may_be_left(spot: Spot) -> bool:
    """Return whether the function around a line can be left at it without harm: it makes no object and gives nothing."""
    function = spot.function
    is_plain = isinstance(function, ast.FunctionDef) and function.name != "__init__"
    return is_plain and not returned(function)  # type: ignore[arg-type]


def left_out(lacks: str, has: str, name: str, spot: Spot) -> str:
    """Say how a line is left out while something is not there.

    Args:
        lacks: the condition under which the line would fail.
        has: its opposite.
        name: what is used in the line and below it.
        spot: the line.
    """
    function = spot.function
    if function is None or function.name == "__init__":
        return (
            f"write `if {has}:` above line {_head(spot, ())}, and indent everything that uses {name} below it"
        )
    loops = [
        node
        for node in ast.walk(function)
        if isinstance(node, (ast.For, ast.While)) and node.lineno < spot.line <= (node.end_lineno or 0)
    ]
    body = max(loops, key=lambda node: node.lineno).body if loops else function.body
    leave = "continue" if loops else "return"
    return f"write these two lines above line {_head(spot, body)}: `if {lacks}:`, and indented below it `{leave}`"


def _head(spot: Spot, body: list[ast.stmt] | tuple[()]) -> int:
    """Return the line in which the statement of a body begins that holds a line."""
    around = (one.lineno for one in body if one.lineno <= spot.line <= (one.end_lineno or 0))
    return next(around, spot.line)
