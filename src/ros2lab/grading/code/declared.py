"""The parameters that code declares, and the values with which it does."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterable


def declarations(code: Iterable[ast.AST]) -> dict[str, list[ast.expr]]:
    """Return by parameter the values with which it is declared."""
    found: dict[str, list[ast.expr]] = defaultdict(list)
    for node in code:
        match node:
            case ast.Call(
                func=ast.Attribute(attr="declare_parameter"),
                args=[ast.Constant(value=str(name)), value, *_],
            ):
                found[name].append(value)
    return found


def parameter_in(call: ast.expr) -> str:
    """Return the name of the parameter that a call gets or declares; empty if it is no such call."""
    match call:
        case ast.Call(
            func=ast.Attribute(attr="get_parameter" | "declare_parameter"),
            args=[ast.Constant(value=str(name)), *_],
        ):
            return name
        case ast.Call(func=ast.Attribute(attr="get_parameter_value", value=inner)):
            return parameter_in(inner)
    return ""
