"""Values of a type that a setter of rclpy asserts without a word: its line names the type, and the line before it the field."""

from __future__ import annotations

import ast
import builtins
import re

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.spots import Spot, place_of, spot_at
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.spelling import with_article

_ASSERTS = re.compile(r"assert isinstance\(\w+, \(?(\w+)")
_SETS = re.compile(r"\.(\w+) = ")


def of_asserted(error: ErrorText, look: Look) -> Finding | None:
    """Return which value has another type than rclpy asserts, and what is written instead; None if the error is another one."""
    report = error.report
    if report is None or report.kind != "AssertionError" or len(report.frames) < 2 or not error.own:
        return None
    if error.own[0] is report.frames[-1]:
        return None  # the student's own line asserts it
    asserts, sets = _ASSERTS.match(report.frames[-1].text.strip()), _SETS.search(report.frames[-2].text)
    if not asserts or not sets:
        return None
    kind = asserts[1].removeprefix("QoS")  # rclpy knows each policy by both names
    home = next((home for home in interfaces.homes_of(kind) if home.startswith("rclpy.")), "")
    spot = spot_at(place_of(error.own, look), look)
    value = _given(spot, sets[1])
    if not home or value is None or hasattr(builtins, kind):
        return None
    text = ast.unparse(value)
    cause = f"{sets[1]} takes {with_article(kind)} of {home}, but `{text}` is none."
    is_known = any(i.local == kind and i.target == f"{home}.{kind}" for i in spot.file.imports)
    more = "" if is_known else f", with `from {home} import {kind}` at the top"
    return Finding("argument-type", cause, spot.place, f"{_written(kind, home, value, spot.file)}{more}")


def _given(spot: Spot, name: str) -> ast.expr | None:
    """Return the value that a statement gives a keyword or an attribute; None if it gives it none."""
    for node in spot.whole:
        match node:
            case ast.keyword(arg=arg, value=value) if arg == name:
                return value
            case ast.Assign(targets=[ast.Attribute(attr=attr)], value=value) if attr == name:
                return value
    return None


def _written(kind: str, home: str, value: ast.expr, source: PythonSource) -> str:
    """Return what to write instead of a value: the member that its text names, any other one, or an object made of it."""
    text, members = ast.unparse(value), interfaces.members_of(home, kind)
    held = getattr(source.written(value), "value", None)
    if kind == "Duration":
        seconds = text if type(held) in (int, float) else "..."
        return f"write `Duration(seconds={seconds})` instead of `{text}`"
    if (meant := str(held).upper()) in members:
        return f"write `{kind}.{meant}` instead of `{text}`"
    known = sorted(name for name in members if name.isupper() and name != "UNKNOWN")
    if known:
        return f"write {' or '.join(f'`{kind}.{name}`' for name in known)} instead of `{text}`"
    return f"write {with_article(kind)} instead of `{text}`"
