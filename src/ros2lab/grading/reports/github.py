"""A grade as annotations of GitHub Actions, shown at the lines of a commit.

Their form: https://docs.github.com/actions/reference/workflow-commands-for-github-actions
"""

from __future__ import annotations

import re

from ros2lab.grading.grade import Fault, Grade
from ros2lab.grading.reports.shown import number, visible

MOST = 10  # GitHub shows no more of a kind for a step

_PLACE = re.compile(r"(?P<file>(?s:.+)\.\w+)(?::(?P<line>\d+))?")


def github(grade: Grade) -> str:
    """Return a grade as log lines that GitHub reads: a warning for each fault, a notice with the points."""
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
    """Return a text escaped so that it ends neither its line nor its property."""
    return re.sub(f"[%\r\n{further}]", lambda match: f"%{ord(match[0]):02X}", text)
