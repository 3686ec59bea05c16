"""How much of a finding is told: its cause, then its place, then its fix.

In a workspace of exercises a diagnosis says no more than it is asked for, so that students find the fault
themselves. A marker file in the workspace's folder says that it is such a workspace.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from enum import Enum
from pathlib import Path

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.error_text import read_error

MARKER = ".one_step_at_a_time"
_MARKER_TEXT = "Here `ros2lab diagnose` gives only the cause at first, and more when asked.\n"


class Step(str, Enum):
    """How far a finding is told."""

    CAUSE = "cause"
    PLACE = "place"
    FIX = "fix"


def go_step_by_step(workspace: Path) -> None:
    """Mark a workspace as one in which a finding is told step by step.

    Raises:
        OSError: if its folder cannot be written.
    """
    workspace.mkdir(parents=True, exist_ok=True)
    (workspace / MARKER).write_text(_MARKER_TEXT, encoding="utf-8")


def is_step_by_step(folder: Path) -> bool:
    """Return whether a folder lies in a workspace in which a finding is told step by step."""
    folder = folder.absolute()
    return any((parent / MARKER).is_file() for parent in (folder, *folder.parents))


def is_text_step_by_step(text: str, folder: Path | None) -> bool:
    """Return whether an error is told step by step; the folder is where the command was typed, if that is known."""
    files = [Path(frame.file) for frame in read_error(text).frames]
    folders = [file.parent for file in files if file.is_absolute()]
    return any(map(is_step_by_step, folders if folder is None else [folder, *folders]))


def told(findings: Iterable[Finding], step: Step) -> list[Finding]:
    """Return the likeliest finding, told as far as a step; empty if there are no findings."""
    for finding in findings:
        place, fix = (finding.place, finding.fix) if step is Step.FIX else (finding.place, "")
        return [replace(finding, place="" if step is Step.CAUSE else place, fix=fix)]
    return []


def next_step(finding: Finding, step: Step) -> Step | None:
    """Return the next step that tells more of a finding; None if all is told."""
    if step is Step.CAUSE and finding.place:
        return Step.PLACE
    return Step.FIX if step is not Step.FIX and finding.fix else None
