"""What makes a lesson one: honest minutes, more doing than watching, a shell that was taught, links to the source."""

from __future__ import annotations

import importlib
import re
from pathlib import Path
from typing import Any

import nbformat
import pytest

from ros2lab import course

NOTEBOOKS = course.notebooks()
OF_EACH = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)

WORDS_PER_MINUTE = 180
# Minutes of a beginner, by what a cell asks for.
MINUTES_TO_RUN, MINUTES_TO_BEGIN, MINUTES_PER_LINE, MINUTES_PER_CHECK = 0.4, 1.0, 0.4, 1.5
MINUTES_PER_CHOICE = 0.2
MOST_ONLY_RUN = 0.42  # of the code cells; the rest the student writes or has checked
SOLUTION = re.compile(r"### BEGIN SOLUTION\n(.*?)### END SOLUTION", re.DOTALL)
# What no lesson teaches; `ros2lab.files` and the editor do the same in words.
UNTAUGHT = r"\bsed\b|<<|\bgrep -[a-zA-Z]*o|\(\) *\{|\bawk\b|\bxargs\b|\bcut\b|\bprintf\b|\buntil\b|\bwhile\b"


def cells_of(path: Path, kind: str) -> list[Any]:
    return [cell for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == kind]


def is_check(source: str) -> bool:
    return re.search(r"^check\.(?!predict\()", source, re.MULTILINE) is not None


def is_clicked(source: str) -> bool:
    return source.startswith(("check.predict(", "check.quiz()"))


def is_prediction(source: str) -> bool:
    return source.startswith("check.predict(")


def questions_of(path: Path) -> list[Any]:
    """Return what a lesson asks, to be answered with a click."""
    checks = importlib.import_module(f"ros2lab.checks.{path.stem.partition('_')[2]}")
    return [*checks.QUIZ, *checks.PREDICTIONS.values()]


def minutes_of(path: Path) -> float:
    """Estimate what a beginner needs: reading, choosing, running, typing the answers, and a check or two."""
    questions = questions_of(path)
    asked = [" ".join([question.text, *question.options, question[3]]) for question in questions]
    prose = " ".join([*(cell.source for cell in cells_of(path, "markdown")), *asked])
    minutes = len(re.findall(r"\w+", prose)) / WORDS_PER_MINUTE + MINUTES_PER_CHOICE * len(questions)
    for cell in cells_of(path, "code"):
        if is_clicked(cell.source):
            continue
        typed = [line for text in SOLUTION.findall(cell.source) for line in text.splitlines() if line.strip()]
        minutes += MINUTES_TO_BEGIN + MINUTES_PER_LINE * len(typed) if typed else MINUTES_TO_RUN
        minutes += MINUTES_PER_CHECK * is_check(cell.source)
    return minutes


@OF_EACH
def test_the_time_is_honest(path: Path) -> None:
    """About what reading at 180 words a minute, and answering at a beginner's pace, take."""
    said = re.search(r"\*\*Time:\*\* (\d+) minutes", cells_of(path, "markdown")[0].source)
    assert said is not None
    assert 0.85 * minutes_of(path) <= int(said[1]) <= 1.25 * minutes_of(path), minutes_of(path)


@OF_EACH
def test_most_cells_are_done_and_not_only_run(path: Path) -> None:
    sources = [cell.source for cell in cells_of(path, "code") if not is_prediction(cell.source)]
    only_run = [source for source in sources if "### BEGIN SOLUTION" not in source and not is_check(source)]
    assert len(only_run) <= MOST_ONLY_RUN * len(sources), f"{len(only_run)} of {len(sources)}"


@OF_EACH
def test_what_the_student_writes_is_asked_for(path: Path) -> None:
    """Above each cell with a solution, within its section, stands a task, or what is to be done."""
    asked = False
    for cell in nbformat.read(path, as_version=4).cells:
        if cell.cell_type == "markdown":
            asked = bool(re.search(r"\*\*(Task|Do)\b", cell.source)) or (
                asked and "\n## " not in f"\n{cell.source}"
            )
        elif "### BEGIN SOLUTION" in cell.source:
            assert asked, cell.source


@OF_EACH
def test_a_prediction_is_made_before_its_answer_is_read(path: Path) -> None:
    """It is clicked, what comes of it is told then, and the cell that shows it comes next."""
    cells = nbformat.read(path, as_version=4).cells
    assert not [
        cell.source
        for cell in cells
        if "**Predict:**" in cell.source or "<summary>What happens" in cell.source
    ]
    for number, cell in enumerate(cells):
        if is_prediction(cell.source):
            later = next(later.source for later in cells[number + 1 :] if later.cell_type == "code")
            assert not is_prediction(later)


@OF_EACH
def test_no_shell_that_was_not_taught(path: Path) -> None:
    for cell in cells_of(path, "code"):
        if cell.source.startswith("%%terminal"):
            assert not re.search(UNTAUGHT, cell.source), cell.source


@OF_EACH
def test_a_lesson_says_what_is_core_and_where_the_documentation_is(path: Path) -> None:
    first, *_, last = (cell.source for cell in cells_of(path, "markdown"))
    assert re.search(r"^\*\*Core:\*\* \w", first, re.MULTILINE)
    assert re.search(r"^\*\*Read more:\*\* .*\]\(https://", last, re.MULTILINE)
