"""What the course asks of an assignment's nodes, asked of a record of them.

The lessons' checks, the hand-in and the demonstration watch nodes each in their own way, and have one judge: the
questions of the grader, with the points of its rubric.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path

from ros2lab.grading import rubric
from ros2lab.grading.evidence import SCHEMA, Build, Evidence, Files, Run
from ros2lab.grading.grade import Judgement
from ros2lab.grading.judging.players import Case
from ros2lab.grading.reading import files as files_of
from ros2lab.grading.receiving.submission import Submission, receive
from ros2lab.grading.verdict import verdict
from ros2lab.scratch import scratch_folder

UNKNOWN = Submission("nothing", None, [], None, [], [])


def case_of(
    runs: Sequence[Run],
    files: Files | None = None,
    build: Build | None = None,
    submission: Submission = UNKNOWN,
) -> Case:
    """Return what was seen as the questions take it; what was not looked at is left empty.

    Args:
        runs: of the programs.
        files: what stands in the files.
        build: what colcon made of them.
        submission: what they are.
    """
    assignment = _rubric().assignment
    evidence = Evidence(
        SCHEMA, assignment.name, "", submission, files or Files(), build, [*runs], {}, {}, "", {}
    )
    return Case(evidence, assignment)


def facts_of(root: Path) -> tuple[Submission, Files]:
    """Return what the grader knows of a folder without building or running anything.

    Raises:
        SubmissionError: if there is nothing that could be graded.
    """
    with scratch_folder() as copy:
        submission = receive(root, copy)
        return submission, files_of.look(copy, submission)


def judged(case: Case, component: str) -> list[Judgement]:
    """Return what the rubric says of a component, such as `status_publisher` or `documentation`."""
    grade = verdict(case.evidence, _rubric())
    return [judgement for judgement in grade.criteria if judgement.component == component]


def lost(case: Case, component: str) -> list[Judgement]:
    """Return what is not worth all of its points in a component."""
    return [judgement for judgement in judged(case, component) if judgement.points < judgement.max]


@cache
def _rubric() -> rubric.Rubric:
    return rubric.load()
