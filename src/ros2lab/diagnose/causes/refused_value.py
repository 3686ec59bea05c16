"""Values that a message's field refuses: where they come from, and what to write or use instead."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.causes.refused_lists import of_list
from ros2lab.diagnose.causes.wrong_literals import of_wrong_literal
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import PythonSource, assigned_to, walk

_SAYS = re.compile(r"The '(?P<field>\w+)' field must be (?P<what>.+)")
_RANGE = re.compile(r"an (?:unsigned )?integer in \[(?P<least>-?\d+), ?(?P<most>\d+)\]")


def of_refused(message: str, spot: Spot, look: Look) -> Finding | None:
    """Return a finding about the value that a field refuses; None if it is not clear which value that is."""
    said = _SAYS.search(message)
    if said is None:
        return None
    given = [value for name, value in _given(spot) if name == said["field"]]
    if literal := of_wrong_literal(message, spot, given, look):
        return literal
    if len({ast.unparse(value) for value in given}) != 1:
        return None
    return of_list(said["field"], said["what"], given[0], spot) or _of_number(spot, given[0], said)


def _of_number(spot: Spot, value: ast.expr, said: re.Match[str]) -> Finding | None:
    """Return a finding about a number that is outside the range of a field, or no float; None for any other."""
    if outside := _RANGE.match(said["what"]):
        return _outside(spot.file, value, said["field"], outside)
    if said["what"].startswith("of type 'float'"):
        return _no_float(spot.file, value, said["field"], spot.line)
    return None


def _given(spot: Spot) -> Iterator[tuple[str, ast.expr]]:
    """Yield the fields that the marked part of a line, or else the line, sets, each with its value."""
    marked = spot.marked
    for node in walk(marked) if isinstance(marked, ast.Call) else spot.nodes:
        match node:
            case ast.Call(keywords=keywords):
                yield from ((keyword.arg, keyword.value) for keyword in keywords if keyword.arg)
            case ast.Assign(targets=[ast.Attribute(attr=name)], value=value):
                yield name, value
            case ast.Assign(targets=[ast.Tuple(elts=targets)], value=ast.Tuple(elts=values)):
                pairs = zip(targets, values, strict=False)
                yield from (
                    (target.attr, value) for target, value in pairs if isinstance(target, ast.Attribute)
                )


def _outside(source: PythonSource, value: ast.expr, field: str, said: re.Match[str]) -> Finding:
    least, most = int(said["least"]), int(said["most"])
    text = ast.unparse(value)
    side, by = _counted(source, text)
    by_count = f": line {by} counts it {'up' if side == 'above' else 'down'}" if by else ""
    cause = f"The field {field} holds whole numbers from {least} to {most}, but `{text}` is outside that range here{by_count}."
    made = (source.resolve(node.func) or "" for node in source.calls)
    sent = next((name for name in made if _range_of(name, field) == (least, most)), "")
    larger = _larger(sent, field, least - (side != "above"), most + (side != "below"))
    keep = f"keep it in that range, for example with min(max({text}, {least}), {most})"
    fix = keep
    if by:
        last = most if side == "above" else least
        fix = keep = (
            f"let line {by} run only while {text} is {'below' if side == 'above' else 'above'} {last}, or cancel the timer that counts"
        )
    if larger:
        fix = f"write {larger} instead of {sent.rpartition('.')[2]} everywhere, including where it is received; or {keep}"
    return Finding("field-type", cause, source.at(value), fix)


def _counted(source: PythonSource, text: str) -> tuple[str, int]:
    """Return on which side a value leaves a range, and the line that counts it that way; 0 if it may be either."""
    changes = [n for n in source.nodes if isinstance(n, ast.AugAssign) and ast.unparse(n.target) == text]
    steps = {type(n.op) if ast.unparse(n.value).isdigit() else None for n in changes}
    if len(steps) == 1 and (step := steps.pop()) in (ast.Add, ast.Sub):
        return "above" if step is ast.Add else "below", changes[0].lineno
    return "", 0


def _range_of(name: str, field: str) -> tuple[int, int] | None:
    """Return the least and greatest number that a field can hold; None if it holds no whole numbers."""
    kind = (interfaces.fields_of(name) or {}).get(field, "")
    match = re.fullmatch(r"(?P<sign>u?)int(?P<bits>\d+)", {"byte": "uint8", "octet": "uint8"}.get(kind, kind))
    if match is None:
        return None
    bits = int(match["bits"])
    return (0, 2**bits - 1) if match["sign"] else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _larger(name: str, field: str, least: int, most: int) -> str:
    """Return the smallest message type with the same field that holds a range; empty if there is none."""
    module, found = name.rpartition(".")[0], []
    for candidate in interfaces.names_in(module) or ():
        there = _range_of(f"{module}.{candidate}", field)
        is_alike = [*(interfaces.fields_of(f"{module}.{candidate}") or {})] == [field]
        if is_alike and there and there[0] <= least and there[1] >= most:
            found.append(((there[0] < 0) != (least < 0), there[1], candidate))
    return min(found)[2] if found else ""


def _no_float(source: PythonSource, value: ast.expr, field: str, line: int) -> Finding:
    text = ast.unparse(value)
    declared = [*_declarations(source, value)]
    defaults = [(call, default) for call in declared for default in call.args[1:2]]
    for call, default in defaults:
        if not isinstance(default, ast.Constant) or type(default.value) is not int:
            continue
        name = _first_text(call)
        cause = f"The field {field} holds a float, but the parameter {name} is declared as {ast.unparse(default)}, an int. Line {line} fails because of this one."
        fix = f"write {ast.unparse(default)}.0 instead of {ast.unparse(default)}"
        return Finding("int-in-float", cause, source.at(default), fix)
    for empty in (call for call in declared if len(call.args) == 1 and not call.keywords):
        name = _first_text(empty)
        cause = f"The field {field} holds a float, but the parameter {name} is declared without a value, so `{text}` is None."
        fix = f"write `{ast.unparse(empty)[:-1]}, 0.0)`, or another number as its default"
        return Finding("int-in-float", cause, source.at(empty), fix)
    cause = f"The field {field} holds a float, but `{text}` is something else here: an int or a string."
    fix = f"write {text}.0" if text.lstrip("-").isdigit() else f"write float({text})"
    return Finding("int-in-float", cause, source.at(value), f"{fix} instead of {text}")


def _declarations(source: PythonSource, value: ast.expr) -> Iterator[ast.Call]:
    """Yield the calls that declare the parameter that a value comes from."""
    made = assigned_to(source.nodes, ast.unparse(value))
    calls = [node for expression in (value, *made) for node in walk(expression) if isinstance(node, ast.Call)]
    asked = {_first_text(call) for call in calls if getattr(call.func, "attr", "") == "get_parameter"}
    own = {id(call) for call in calls}
    for node in source.nodes:
        is_declared = isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "declare_parameter"
        if isinstance(node, ast.Call) and is_declared and (_first_text(node) in asked or id(node) in own):
            yield node


def _first_text(call: ast.Call) -> str:
    first = call.args[0] if call.args else None
    return first.value if isinstance(first, ast.Constant) and isinstance(first.value, str) else "?"
