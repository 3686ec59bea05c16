"""Passes on what explains itself: an exception, or the sentence of a tool."""

from __future__ import annotations

from dataclasses import replace

from ros2lab.diagnose.explaining.said import of_launch, of_python, passed_on
from ros2lab.diagnose.explaining.warnings_told import of_warning
from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorReport, ErrorText, own_frames
from ros2lab.diagnose.printed.spots import place_of
from ros2lab.diagnose.printed.transcript import harmless_lines, step_with

_SAY_NOTHING = frozenset(("KeyboardInterrupt", "SystemExit", "CheckError", "TerminalError"))


def said_by_tools(error: ErrorText, look: Look) -> list[Finding]:
    """Return the message of an exception or a tool; empty if there is none to pass on."""
    reports = [report for report in error.reports[-1:] if report.kind not in _SAY_NOTHING]
    harmless = harmless_lines(error.steps)
    said = (
        [_of_report(report, error, look) for report in reports]
        if reports
        else [passed_on(line, error, look) for line in lines_of(error) if line not in harmless]
    )
    found = [finding for finding in said if finding is not None][:1]
    if not found and look and "Caught exception in launch" in error.text:
        found = [finding for finding in [of_launch(error, look)] if finding]
    if found and "Warning: " in error.decisive and step_with(error.decisive, error.steps).ended_well:
        only = "The command succeeded; this is only a warning."
        return [replace(finding, cause=f"{only} {finding.cause}") for finding in found]
    return found


def _of_report(report: ErrorReport, error: ErrorText, look: Look) -> Finding | None:
    """Return what an exception says about a line of the student's, or a warning that is printed like one."""
    place = place_of(own_frames(report.frames), look)
    # Python prints a warning after its place; an exception is at the beginning of its line.
    if report.kind.endswith("Warning") and f": {report.line}" in error.text:
        frame = report.frames[-1] if report.frames else None
        said = of_warning(f"{frame.file}:{frame.line}: {report.line}", error.text, look) if frame else None
        return said or Finding(SAID, f"Python warns: {report.message.rstrip('.')}.", place)
    return of_python(report, place, look)


def lines_of(error: ErrorText) -> list[str]:
    """Return the lines that may name the error: the exceptions, the last first, then all other lines."""
    exceptions = [report.line for report in reversed(error.reports) if report.kind not in _SAY_NOTHING]
    return [
        *exceptions,
        *(line for line in error.text.splitlines() if line.strip() and line not in exceptions),
    ]
