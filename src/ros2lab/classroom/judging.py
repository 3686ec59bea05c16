"""From evidence in the gradebook to what a submission is worth: by a rubric, with the instructor's decisions."""

from __future__ import annotations

import dataclasses
import itertools
import json
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from ros2lab import assignments
from ros2lab.classroom import identity
from ros2lab.classroom.gradebook import Gradebook, Row, Worth
from ros2lab.classroom.handed_in import ClassError, called
from ros2lab.grading import rubric as rubrics
from ros2lab.grading.evidence import Evidence
from ros2lab.grading.evidence_json import EvidenceError, read_evidence
from ros2lab.grading.grade import Fault, Grade, Judgement, Override, Points
from ros2lab.grading.overrides import Decision
from ros2lab.grading.reports.as_json import as_json
from ros2lab.grading.rubric import Rubric
from ros2lab.grading.verdict import verdict

AT_ONCE = 50  # submissions that are judged in one transaction; fewer are not worth a second process
TOGETHER = 5  # submissions that a process takes at a time

Decisions = Mapping[str, Mapping[str, "tuple[float, str, str]"]]


@dataclass(frozen=True)
class Judging:
    """By what a class is judged.

    Attributes:
        assignment: its folder; None for the course's own.
        rubric: what the points are given for.
        assignment_digest: of what was asked for.
        rubric_digest: of what the points are given for.
        decisions: what instructors have decided, by student and criterion.
    """

    assignment: Path | None
    rubric: Rubric
    assignment_digest: str
    rubric_digest: str
    decisions: Decisions

    @classmethod
    def of(cls, assignment: Path | None, rubric: Path | None, decisions: Decisions) -> Judging:
        """Read an assignment and a rubric; None for the course's own.

        Raises:
            ClassError: if one of them cannot be used.
        """
        try:
            asked = assignments.load(assignment)
            path = rubric or (assignment / "rubric.yaml" if assignment else None)
            return cls(
                assignment,
                rubrics.load(path, asked),
                identity.assignment(assignment),
                identity.rubric(assignment, rubric),
                decisions,
            )
        except (assignments.AssignmentError, rubrics.RubricError) as error:
            raise ClassError(str(error)) from None

    def by(self, student: str) -> str:
        """Return the digest of all that a student's points are given by."""
        own = self.decisions.get(student, {})
        return f"{self.rubric_digest} {json.dumps(own, sort_keys=True)}" if own else self.rubric_digest

    def worth(self, evidence: str, student: str, name: str) -> Worth | str:
        """Return what a student's submission is worth; a sentence if its evidence cannot be judged."""
        try:
            grade = self.grade(read_evidence(evidence), student, name)
        except EvidenceError as error:
            return str(error)
        except Exception as error:  # a fault of a question must not end the class
            return (
                f"The evidence could not be judged, which is no fault of the submission: {type(error).__name__}: "
                f"{error}"
            )
        return Worth(grade.total, grade.max, as_json(grade), self.by(student))

    def grade(self, evidence: Evidence, student: str, name: str) -> Grade:
        """Return the grade of a student's submission."""
        known = {criterion.id for criterion in self.rubric.criteria}
        own = self.decisions.get(student, {})
        decisions = {key: Decision(*given) for key, given in own.items() if key in known}
        return verdict(dataclasses.replace(evidence, name=name), self.rubric, decisions)


@dataclass(frozen=True)
class JudgedAgain:
    """What came of judging again.

    Attributes:
        judged: how many were judged again.
        changed: how many of them have other points now.
        problems: a sentence for each name that could not be judged again, and kept what it had.
    """

    judged: int
    changed: int
    problems: Mapping[str, str]


def regrade(
    book: Gradebook,
    judging: Judging,
    rows: Iterable[Row],
    show: Callable[[int, int], None] = lambda _done, _all: None,
) -> JudgedAgain:
    """Judge again what was judged by something else, without a run, on all cores.

    Args:
        book: the gradebook, into which the new points go.
        judging: by what is judged.
        rows: of the gradebook.
        show: called with how many are done, and of how many.

    Raises:
        ClassError: if the class has handed in for another assignment.
    """
    rows = [*rows]
    check_assignment(book, judging, rows)
    stale = [row for row in rows if row.worth and row.worth.rubric != judging.by(row.handed.key)]
    names = called(row.handed for row in rows)
    show(0, len(stale))
    done, changed, problems = 0, 0, dict[str, str]()
    with _judges(judging, len(stale) // AT_ONCE) as judged:
        parts = (stale[start : start + AT_ONCE] for start in range(0, len(stale), AT_ONCE))
        for some, worth_of_each in _begun_ahead((part, judged(_given(book, part))) for part in parts):
            worths: dict[int, dict[str, Worth | str]] = {}
            for row, worth in zip(some, worth_of_each, strict=True):
                if isinstance(worth, str):
                    problems[names[row.handed.key]] = worth
                    continue
                worths.setdefault(row.grading, {})[row.handed.key] = worth
                changed += worth.total != (row.worth.total if row.worth else None)
            book.judge(worths)
            done += len(some)
            show(done, len(stale))
    return JudgedAgain(len(stale) - len(problems), changed, problems)


Given = tuple[str, str, str]  # the evidence on a submission, and the student's key and name
Begun = TypeVar("Begun")


def _given(book: Gradebook, rows: Iterable[Row]) -> list[Given]:
    return [(book.evidence(row.grading), row.handed.key, row.handed.name) for row in rows]


def _begun_ahead(items: Iterator[Begun]) -> Iterator[Begun]:
    """Yield each item once the next one was begun, so that nobody waits for work while a result is written."""
    for before, _ in itertools.pairwise(itertools.chain(items, [None])):
        if before is not None:
            yield before


@contextmanager
def _judges(judging: Judging, most: int) -> Iterator[Callable[[Sequence[Given]], Iterator[Worth | str]]]:
    """Give a function that judges submissions: in this process, or in one on each core, but at most in so many."""
    processes = min(most, len(os.sched_getaffinity(0)))
    if processes < 2:
        yield lambda given: itertools.starmap(judging.worth, given)
        return
    with ProcessPoolExecutor(
        processes,
        # A fork would share the gradebook's connection.
        mp_context=multiprocessing.get_context("spawn"),
        initializer=_follow_the_parent,
    ) as pool:
        yield lambda given: pool.map(judging.worth, *zip(*given, strict=True), chunksize=TOGETHER)


def _follow_the_parent() -> None:
    """Leave it to the process that has the gradebook when to end: at a Ctrl-C, which reaches all, and when killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_parent, daemon=True).start()


def _end_with_the_parent() -> None:
    if parent := multiprocessing.parent_process():
        parent.join()
        os._exit(1)


def check_assignment(book: Gradebook, judging: Judging, rows: Iterable[Row]) -> None:
    """Refuse to judge a class by another assignment than that for which it has handed in.

    Raises:
        ClassError: with both, and what to do.
    """
    number = next((row.grading for row in rows if row.grading), 0)
    given = json.loads(book.evidence(number))["assignment"] if number else judging.rubric.assignment.name
    if given != judging.rubric.assignment.name:
        raise ClassError(
            f"This class has handed in for {given!r}, and not for {judging.rubric.assignment.name!r}; give the folder "
            "of that assignment with --assignment, or another gradebook."
        )


def read_grade(text: str) -> Grade:
    """Read a grade that `as_json` wrote."""
    data = json.loads(text)
    data["components"] = {name: Points(**given) for name, given in data["components"].items()}
    data["faults"] = [Fault(**fault) for fault in data["faults"]]
    for criterion in data["criteria"]:
        if "override" in criterion:
            criterion["override"] = Override(**criterion["override"])
    data["criteria"] = [Judgement(**criterion) for criterion in data["criteria"]]
    data.pop("run", None)  # which it has of itself
    return Grade(**data)
