"""The way through a lesson: which cells a student runs, in which order, and what must come of it."""

from __future__ import annotations

import enum
import re
from collections.abc import Sequence
from typing import Any, NamedTuple

BEGIN = "### BEGIN SOLUTION"


class Outcome(enum.Enum):
    """What must come of a cell."""

    HARMLESS = "no error"
    NOT_YET = "a check that refuses, with a hint"
    RIGHT = "a check that says Right"
    ASKED = "questions, of which none is answered"


class Run(NamedTuple):
    """One run of a cell.

    Attributes:
        index: the cell's place in the notebook.
        is_answered: whether the solution is typed in, between the marks that are comments; a cell without one is as
            it is.
        outcome: what must come of it.
        is_last: whether the cell is not run again, so that its outputs are those that stay. A quiz is run again
            after all else, once it has been answered with clicks; what it shows unanswered is what is stored.
    """

    index: int
    is_answered: bool
    outcome: Outcome
    is_last: bool


def way_through(cells: Sequence[Any]) -> list[Run]:
    """Return the runs of a lesson's code cells in a student's order.

    What belongs to a task is first run as it was delivered, so that its checks are seen to refuse, and then
    answered. A check that stands further down, and rests on the same answer, is seen to refuse with it.

    Args:
        cells: those of the worked notebook.
    """
    runs: list[Run] = []
    index = 0
    while index < len(cells):
        end = _end_of_group(cells, index)
        group = [place for place in range(index, end) if cells[place].cell_type == "code"]
        if any(BEGIN in cells[place].source for place in group):
            later = [place for place in _until_the_next_answer(cells, end) if is_check(cells[place])]
            runs += [_blank(cells, place) for place in [*group, *later]]
        runs += [_answered(cells, place) for place in group]
        index = end
    quizzes = [place for place, cell in enumerate(cells) if is_quiz(cell)]
    return runs + [Run(place, True, Outcome.RIGHT, False) for place in quizzes]


def is_check(cell: Any) -> bool:
    """Return whether a cell is a check of what was written above it."""
    is_one = cell.cell_type == "code" and bool(re.search(r"^check\.", cell.source, re.MULTILINE))
    return is_one and not is_quiz(cell) and not cell.source.startswith("check.predict(")


def is_quiz(cell: Any) -> bool:
    """Return whether a cell asks the questions of a lesson."""
    return cell.cell_type == "code" and cell.source.strip() == "check.quiz()"


def _end_of_group(cells: Sequence[Any], index: int) -> int:
    """Return where the group ends that begins with a cell: a task's with its check, any other one with the cell.

    Tasks that follow one another share a check. One after which the lesson goes on without a check has none.
    """
    if not _is_task(cells[index]):
        return index + 1
    goes_on = False
    for place in range(index + 1, len(cells)):
        cell = cells[place]
        if is_check(cell):
            return place + 1
        if _is_task(cell) and goes_on:
            break
        goes_on |= cell.cell_type == "code" and BEGIN not in cell.source
    return index + 1


def _is_task(cell: Any) -> bool:
    return cell.cell_type == "markdown" and "**Task" in cell.source


def _until_the_next_answer(cells: Sequence[Any], index: int) -> range:
    answers = (place for place in range(index, len(cells)) if BEGIN in cells[place].source)
    return range(index, next(answers, len(cells)))


def _blank(cells: Sequence[Any], index: int) -> Run:
    outcome = Outcome.NOT_YET if is_check(cells[index]) else Outcome.HARMLESS
    return Run(index, False, outcome, False)


def _answered(cells: Sequence[Any], index: int) -> Run:
    if is_quiz(cells[index]):
        return Run(index, False, Outcome.ASKED, True)
    return Run(index, True, Outcome.RIGHT if is_check(cells[index]) else Outcome.HARMLESS, True)
