"""How to skip the rest of a function while a value is missing."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.own_functions import returned
from ros2lab.diagnose.sources.python_source import contains


def may_be_left(spot: Spot) -> bool:
    """Return whether a function may return early at a line: it is no constructor and returns no value."""
    function = spot.function
    is_plain = isinstance(function, ast.FunctionDef) and function.name != "__init__"
    return is_plain and not returned(function)  # type: ignore[arg-type]


def left_out(lacks: str, has: str, name: str, spot: Spot) -> str:
    """Return how to skip a line, and what uses a name below it, under the condition `lacks`, the opposite of `has`."""
    function = spot.function
    if function is None or function.name == "__init__":
        return (
            f"write `if {has}:` above line {head(spot, ())}, and indent everything that uses {name} below it"
        )
    loops = [
        node
        for node in ast.walk(function)
        if isinstance(node, (ast.For, ast.While)) and node.lineno < spot.line <= (node.end_lineno or 0)
    ]
    body = max(loops, key=lambda node: node.lineno).body if loops else function.body
    leave = "continue" if loops else "return"
    return (
        f"write these two lines above line {head(spot, body)}: `if {lacks}:`, and indented below it `{leave}`"
    )


def head(spot: Spot, body: Sequence[ast.stmt]) -> int:
    """Return the first line of the statement in a body that contains the line."""
    return next((statement.lineno for statement in body if contains(statement, spot.line)), spot.line)
