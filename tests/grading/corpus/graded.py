"""A case of the corpus, graded as `ros2lab grade` does it."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from corpus import CASES
from ros2lab import assignments
from ros2lab.grading import rubric
from ros2lab.grading.clean_copy import SubmissionError
from ros2lab.grading.collect import collect
from ros2lab.grading.grade import Grade
from ros2lab.grading.verdict import verdict

from corpus.case import Case  # isort: skip


@dataclass(frozen=True)
class Outcome:
    """What a case got.

    Attributes:
        grade: None if nothing could be received.
        refused: why, then.
        problems: in what it is not what the case must get; a sentence each.
    """

    grade: Grade | None
    refused: str
    problems: list[str]


def graded(case: Case, folder: Path) -> Outcome:
    """Make a case's submission below an empty folder, and grade it."""
    try:
        with case.handed_in(folder) as path:
            try:
                grade = verdict(
                    collect(path, assignment=_rubric(case.assignment).assignment), _rubric(case.assignment)
                )
            except SubmissionError as error:
                return Outcome(None, str(error), [] if case.is_refused else [f"It was refused: {error}"])
    except AssertionError as harm:
        return Outcome(None, "", [f"Harm was done: {harm}"])
    if case.is_refused:
        return Outcome(grade, "", ["It had to be refused, and was graded."])
    return Outcome(grade, "", case.problems(grade))


@cache
def _rubric(folder: Path | None) -> rubric.Rubric:
    path = folder / "rubric.yaml" if folder else None
    return rubric.load(path, assignments.load(folder))


def outcome(name: str) -> Outcome:
    """Grade the case of this name in a folder of its own."""
    case = next(case for case in CASES if case.name == name)
    with tempfile.TemporaryDirectory(prefix="ros2lab-corpus-") as folder:
        return graded(case, Path(folder))
