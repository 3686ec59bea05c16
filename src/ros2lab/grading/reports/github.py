"""A grade as annotations of GitHub Actions, which stand at the lines of a commit.

Their form: https://docs.github.com/actions/reference/workflow-commands-for-github-actions
"""

from __future__ import annotations

import re

from ros2lab.grading.grade import Fault, Grade
from ros2lab.grading.reports.shown import number, visible

MOST = 10  # GitHub shows no more of a kind for a step

_PLACE = re.compile(r"(?P<file>[^:]+\.\w+)(?::(?P<line>\d+))?")


def github(grade: Grade) -> str:
    """Return a grade as lines that GitHub reads in a log: a warning for each fault, and a notice with the points."""
    lines = [_warning(fault) for fault in grade.faults[:MOST]]
    said = f"{visible(grade.submission)}: {number(grade.total)} of {number(grade.max)} points"
    lines.append(f"::notice title=ros2lab::{_escaped(said)}")
    return "\n".join(lines) + "\n"


def _warning(fault: Fault) -> str:
    properties = {"title": visible(fault.component)}
    if place := _PLACE.fullmatch(fault.place):
        properties |= {name: visible(value) for name, value in place.groupdict().items() if value}
    listed = ",".join(f"{name}={_escaped(value, ':,')}" for name, value in properties.items())
    fix = f"\nFix: {visible(fault.fix, keeps_lines=True)}" if fault.fix else ""
    return f"::warning {listed}::{_escaped(visible(fault.cause) + fix)}"


def _escaped(text: str, further: str = "") -> str:
    """Return a text that ends neither its line nor its property."""
    return re.sub(f"[%\r\n{further}]", lambda match: f"%{ord(match[0]):02X}", text)
