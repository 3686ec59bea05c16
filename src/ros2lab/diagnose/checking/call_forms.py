"""The call of which a type checker speaks, and the forms in which it may have been meant."""

from __future__ import annotations

import ast

from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.calls import meant_call, one_each, whole_call
from ros2lab.diagnose.sources.python_source import PythonSource


def as_it_was_meant(source: PythonSource, call: ast.Call) -> dict[str, str]:
    """Return a call as the library's signature has it, and one call for each item of a list, with how that is told."""
    each = one_each(call)
    ways = {each[0]: f"write one line for each: {'; '.join(each)}"} if each else {}
    return {whole_call(source, call): meant, **ways} if (meant := meant_call(source, call)) else ways


def rewritten(call: ast.Call, rule: str, said: dict[str, str]) -> dict[str, str]:
    """Return a call with what it lacks, under the name that it has there, without what is too much, or with other values."""
    given = [*map(ast.unparse, call.args)]
    forms: list[list[str]] = []
    if rule == "missing-argument":
        forms = [[*given, said["name"].strip("`")]]
    elif rule == "too-many-positional-arguments":
        forms = [given[:number] for number in range(len(given) - 1, -1, -1)]
    elif rule == "invalid-argument-type":
        changes = ("{}()", "{}.value", "{}.data", "float({})", "int({})")
        forms = [
            [*given[:number], change.format(value), *given[number + 1 :]]
            for number, value in enumerate(given)
            for change in changes
        ]
    named = [f"{one.arg}={ast.unparse(one.value)}" for one in call.keywords]
    texts = [f"{ast.unparse(call.func)}({', '.join([*form, *named])})" for form in forms]
    return {text: f"write `{text}`" for text in texts}


def call_at(spot: Spot, column: int, rule: str) -> ast.Call | None:
    """Return the call about which a type checker speaks at a line and a column."""

    def begins(node: ast.AST) -> bool:
        return (getattr(node, "lineno", 0), getattr(node, "col_offset", -1)) == (spot.line, column)

    for node in spot.source.nodes if spot.source else ():
        if isinstance(node, ast.Call) and any(
            map(begins, [node] if rule == "missing-argument" else [*node.args, *node.keywords])
        ):
            return node
    return None
