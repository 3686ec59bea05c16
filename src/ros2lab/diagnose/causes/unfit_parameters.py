"""Values that no parameter can hold, or that do not fit the type that is asked for with them."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from typing import Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.python_source import argument, last_name

_NOT_ALLOWED = re.compile(r"not (?:one|a list of one) of the allowed types '(?P<value>.*)'")
_DISAGREE = re.compile(r"Type 'Type\.(?P<kind>\w+)' and value '(?P<value>.*)' do not agree")
_MADE = {"DOUBLE": float, "INTEGER": int, "STRING": str, "BOOL": bool}
# A value of each type, as it is written.
_SUCH = {"DOUBLE": "0.5", "INTEGER": "1", "STRING": "'a'", "BOOL": "False", "BYTE": "b'a'"}


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
            better = _alike(_flat(value)) if isinstance(value, (list, tuple)) else None
            cause = f"A parameter cannot hold {text}: only a bool, a number, a string, or a list of values of one of these types."
        if isinstance(value, dict) and (written := _by_key(value, spot)):
            return Finding(
                "argument-type", cause, spot.file.at(node), f"write {written}: one parameter for each key"
            )
        if better is not None:
            size = {len(row) for row in value if isinstance(row, (list, tuple))} if refused else set()
            more = f", and take {size.pop()} values at a time where it is read" if len(size) == 1 else ""
            return Finding(
                "argument-type", cause, spot.file.at(node), f"write {better!r} instead of {text}{more}"
            )
    declared = next((c for c in spot.calls if last_name(c.func) == "declare_parameter"), None)
    value = argument(declared, 1, "value") if declared and refused else None
    if value is None:
        return None
    cause = f"A parameter cannot hold {ast.unparse(value)}: only a bool, a number, a string, or a list of values of one of these types."
    fix = f"declare a parameter of its own for each number or text in {ast.unparse(value)}, or a flat list of them"
    return Finding("argument-type", cause, spot.file.at(value), fix)


def unset(match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for a parameter that is declared with a type only."""
    name = match["name"]
    for call in spot.file.calls:
        given = argument(call, 1, "value")
        if last_name(call.func) != "declare_parameter" or given is None or _literal(call.args[0]) != name:
            continue
        kind = last_name(given)
        one = _SUCH.get(kind.removesuffix("_ARRAY"))
        if one is not None:
            example = f"[{one}]" if kind.endswith("_ARRAY") else one
            cause = f"The parameter {name} is declared with the type {kind}, but has no value."
            fix = f"write a default of this type, such as {example}, instead of {ast.unparse(given)}, or give the value at the start: `--ros-args -p {name}:=...`"
            return cause, fix
    return f"The parameter {name} has a type but no value.", "give declare_parameter a default of this type"


def _flat(values: Any) -> list[Any]:
    """Return the items of a list, and those of lists in it."""
    return [
        inner for item in values for inner in (_flat(item) if isinstance(item, (list, tuple)) else [item])
    ]


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
    if len(kinds) == 1 and kinds <= {int, float, str, bool}:
        return values
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
