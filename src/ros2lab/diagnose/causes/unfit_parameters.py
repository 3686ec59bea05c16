"""Values that no parameter can hold, or that do not fit the type that is asked for with them."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from typing import Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.spots import Spot

_NOT_ALLOWED = re.compile(r"not (?:one|a list of one) of the allowed types '(?P<value>.*)'")
_DISAGREE = re.compile(r"Type 'Type\.(?P<kind>\w+)' and value '(?P<value>.*)' do not agree")
_MADE = {"DOUBLE": float, "INTEGER": int, "STRING": str, "BOOL": bool}


def of_unfit_parameter(message: str, spot: Spot) -> Finding | None:
    """Return a finding about the value of a parameter that rclpy refuses; None for any other error."""
    refused, unlike = _NOT_ALLOWED.search(message), _DISAGREE.search(message)
    said = refused or unlike
    if said is None:
        return None
    for node in _values(spot):
        value = _literal(node)
        if value is None or said["value"] != str(value):
            continue
        text = ast.unparse(node)
        if unlike:
            kind = unlike["kind"].removesuffix("_ARRAY")
            better = _as(value, _MADE.get(kind))
            cause = f"The parameter is said to be of type {unlike['kind']}, but {text} is none."
        else:
            better = _alike(value) if isinstance(value, (list, tuple)) else None
            cause = f"A parameter cannot hold {text}: only a bool, a number, a string, or a list of values of one of these types."
        if isinstance(value, dict) and (written := _by_key(value, spot)):
            return Finding(
                "argument-type", cause, spot.file.at(node), f"write {written}: one parameter for each key"
            )
        if better is not None:
            return Finding("argument-type", cause, spot.file.at(node), f"write {better!r} instead of {text}")
    return None


def _values(spot: Spot) -> Iterator[ast.expr]:
    """Yield the expressions of a line, and what is assigned to the names in it."""
    for node in spot.whole:
        if isinstance(node, ast.expr):
            yield node
            if isinstance(node, (ast.Name, ast.Attribute)):
                yield from spot.assigned(ast.unparse(node))


def _literal(node: ast.expr) -> Any:
    try:
        return ast.literal_eval(node)
    except (ValueError, TypeError, SyntaxError):
        return None


def _as(value: Any, kind: type | None) -> Any:
    """Return a value, or each item of a list, as another type; None if it cannot be."""
    try:
        if isinstance(value, (list, tuple)):
            return [kind(item) for item in value] if kind else None
        return kind(value) if kind else None
    except (ValueError, TypeError):
        return None


def _alike(values: Any) -> Any:
    """Return a list with items of one type; None if they have nothing in common."""
    kinds = {type(item) for item in values}
    if kinds <= {int, float}:
        return [float(item) for item in values]
    return [str(item) for item in values] if kinds <= {int, float, str, bool} and str in kinds else None


def _by_key(value: dict[Any, Any], spot: Spot) -> str:
    """Return the calls that declare a parameter for each key of a dictionary; empty if that is not what is asked."""
    for call in spot.whole:
        match call:
            case ast.Call(
                func=ast.Attribute(attr="declare_parameter"), args=[ast.Constant(value=str(name)), *_]
            ):
                own = ast.unparse(call.func)
                return " and ".join(f"`{own}({f'{name}.{key}'!r}, {item!r})`" for key, item in value.items())
    return ""
