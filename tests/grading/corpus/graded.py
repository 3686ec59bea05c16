"""A case of the corpus, graded as `ros2lab grade` does it."""

from __future__ import annotations

import multiprocessing
import re
import signal
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from corpus import CASES, HINTS
from ros2lab import assignments
from ros2lab.grading import rubric
from ros2lab.grading.collect import collect
from ros2lab.grading.grade import Grade
from ros2lab.grading.receiving.clean_copy import SubmissionError
from ros2lab.grading.verdict import verdict

from corpus.case import Case, said_of  # isort: skip
from corpus.hints import Hint  # isort: skip
from corpus.tree import Files, as_folder, made  # isort: skip

WORKSPACE = "robot_project_ws"


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


def followed(hint: Hint, folder: Path) -> Outcome:
    """Grade a fault below an empty folder, do what its report says, and grade it again."""
    before = graded(hint.case, folder / "before").grade
    files: Files = {
        str(path.relative_to(folder / "before" / WORKSPACE)): path.read_text()
        for path in (folder / "before" / WORKSPACE).rglob("*")
        if path.is_file()
    }
    done = Case(hint.name, hint.case.about, as_folder(made(files, hint.change), WORKSPACE))
    after = graded(done, folder / "after").grade
    return Outcome(after, "", [*disappointments(hint, before, after)])


def disappointments(hint: Hint, before: Grade | None, after: Grade | None) -> Iterator[str]:
    """Yield in what a hint was not given, or did not keep what it promised; a sentence each."""
    if before is None or after is None:
        yield "It could not be graded."
        return
    said = said_of(before, hint.criterion.partition(".")[0])
    if not re.search(hint.says, said):
        yield f"The report must say {hint.says!r}, and says: {said}"
    points = [
        next(one.points for one in grade.criteria if one.id == hint.criterion) for grade in (before, after)
    ]
    if points[0] >= points[1]:
        yield f"{hint.criterion} had {points[0]:g} points, and has {points[1]:g} now."
    for name, part in before.components.items():
        if after.components[name].points < part.points:
            yield f"{name} had {part.points:g} points, and has {after.components[name].points:g} now."


def each_graded(names: Iterable[str], jobs: int) -> Iterator[tuple[str, Outcome]]:
    """Yield the name and the outcome of each case or hint of these names, as they come, several at a time.

    Each is graded in another process, for each attack has a secret of its own in the environment. Ctrl-C ends these
    at once; what they have written lies in a folder that is deleted here.
    """
    with (
        tempfile.TemporaryDirectory(prefix="ros2lab-corpus-", ignore_cleanup_errors=True) as folder,
        multiprocessing.get_context("spawn").Pool(jobs, _begin, [folder]) as pool,
    ):
        yield from pool.imap_unordered(_outcome, names)


def _begin(folder: str) -> None:
    """Begin a process that grades, with its temporary files in a folder."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    tempfile.tempdir = folder


def _outcome(name: str) -> tuple[str, Outcome]:
    """Grade the case, or follow the hint, of this name in a folder of its own."""
    case = next(case for case in (*CASES, *HINTS) if case.name == name)
    with tempfile.TemporaryDirectory() as folder:
        return name, graded(case, Path(folder)) if isinstance(case, Case) else followed(case, Path(folder))
