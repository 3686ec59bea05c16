"""What the student's way is judged by objects to what is wrong, so that a green run means something."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nbformat
import pytest
from judging import StoredOutputs, what_is_wrong
from lesson_way import Outcome, Run, is_check, is_quiz, way_through
from nbformat.v4 import new_code_cell, new_markdown_cell, new_output

from ros2lab import course

NOTEBOOKS = course.notebooks()
ERROR = new_output("error", ename="NameError", evalue="", traceback=["NameError: x"])
REFUSAL = new_output(
    "error", ename="CheckError", evalue="", traceback=["Not yet. Expected: 1. Found: 2. Hint: count again."]
)
BARE_REFUSAL = new_output("error", ename="CheckError", evalue="", traceback=["Not yet."])
RIGHT = new_output("execute_result", data={"text/plain": "Right: one."})
ASKED = new_output("execute_result", data={"text/plain": "Quiz: 0 of 3 questions answered."})
HALF = new_output("execute_result", data={"text/plain": "Quiz: 1 of 3 questions answered."})
TEXT = new_output("stream", name="stdout", text="Right, he said.\n")


@pytest.mark.parametrize(
    ("outcome", "outputs", "is_well"),
    [
        (Outcome.HARMLESS, [TEXT], True),
        (Outcome.HARMLESS, [TEXT, ERROR], False),
        (Outcome.HARMLESS, [REFUSAL], False),
        (Outcome.NOT_YET, [REFUSAL], True),
        (Outcome.NOT_YET, [RIGHT], False),  # a check that cannot fail
        (Outcome.NOT_YET, [], False),
        (Outcome.NOT_YET, [ERROR], False),
        (Outcome.NOT_YET, [BARE_REFUSAL], False),
        (Outcome.RIGHT, [RIGHT], True),
        (Outcome.RIGHT, [REFUSAL], False),
        (Outcome.RIGHT, [TEXT], False),
        (Outcome.RIGHT, [], False),
        (Outcome.RIGHT, [ASKED], False),
        (Outcome.ASKED, [ASKED], True),
        (Outcome.ASKED, [HALF], False),
        (Outcome.ASKED, [RIGHT], False),
        (Outcome.ASKED, [], False),
    ],
)
def test_what_comes_of_a_cell_is_judged(outcome: Outcome, outputs: list[Any], is_well: bool) -> None:
    """An error where none should be, and a check that says the wrong thing or nothing, are found."""
    assert (what_is_wrong(Run(0, False, outcome, False), outputs) == "") == is_well


def test_a_spoilt_output_is_objected_to(request: pytest.FixtureRequest) -> None:
    """One letter that differs from what is stored is found, and what is stored is not objected to."""
    path = NOTEBOOKS[0]
    cells = nbformat.read(path, as_version=4).cells
    stored = StoredOutputs(path, way_through(cells), request.session)
    printing = [
        (index, cell)
        for index, cell in enumerate(cells)
        if cell.cell_type == "code" and any(output.output_type == "stream" for output in cell.outputs)
    ]
    index, cell = printing[0]
    assert stored.difference(index, cell.outputs) == ""
    cell.outputs[0].text = cell.outputs[0].text.replace("e", "3", 1)
    assert stored.difference(index, cell.outputs) != ""


def test_a_task_is_tried_before_it_is_answered() -> None:
    """Its cells are run as delivered, then answered; a later check of the same answer is seen to refuse with it."""
    solution = "### BEGIN SOLUTION\n1\n### END SOLUTION"
    cells = [
        new_code_cell("import x"),
        new_markdown_cell("**Task: count.**"),
        new_code_cell(solution),
        new_markdown_cell("Try it."),
        new_code_cell("try_it()"),
        new_code_cell("check.counted()"),
        new_code_cell("start()"),
        new_code_cell("check.runs()"),
        new_markdown_cell("**Do: type it.**"),
        new_code_cell(solution),
        new_code_cell('check.predict("one")'),
        new_code_cell(f"check.letters(\n{solution}\n)"),
        new_code_cell("check.quiz()"),
    ]
    harmless, not_yet, right = Outcome.HARMLESS, Outcome.NOT_YET, Outcome.RIGHT
    assert way_through(cells) == [
        Run(0, True, harmless, True),
        *(Run(2, False, harmless, False), Run(4, False, harmless, False)),
        *(Run(5, False, not_yet, False), Run(7, False, not_yet, False)),
        *(Run(2, True, harmless, True), Run(4, True, harmless, True), Run(5, True, right, True)),
        *(Run(6, True, harmless, True), Run(7, True, right, True)),
        *(Run(9, False, harmless, False), Run(9, True, harmless, True)),
        Run(10, True, harmless, True),
        *(Run(11, False, not_yet, False), Run(11, True, right, True)),
        *(Run(12, False, Outcome.ASKED, True), Run(12, True, right, False)),
    ]


def test_a_task_without_a_check_is_tried_cell_by_cell() -> None:
    """What the lesson does next, such as ending what runs, is not done before the answer."""
    answer = new_code_cell("### BEGIN SOLUTION\n1\n### END SOLUTION")
    cells = [new_markdown_cell("**Task: look.**"), answer, new_code_cell("end()")]
    cells += [new_markdown_cell("**Task: change it.**"), answer, new_code_cell("check.changed()")]
    tried = [Run(1, False, Outcome.HARMLESS, False), Run(1, True, Outcome.HARMLESS, True)]
    assert way_through(cells)[:4] == [
        *tried,
        Run(2, True, Outcome.HARMLESS, True),
        Run(4, False, Outcome.HARMLESS, False),
    ]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_every_check_is_seen_to_refuse_and_to_accept(path: Path) -> None:
    """Whatever the order of a lesson's cells is, each is run, and no check with the answer alone."""
    cells = nbformat.read(path, as_version=4).cells
    runs = way_through(cells)
    code = [index for index, cell in enumerate(cells) if cell.cell_type == "code"]
    assert [run.index for run in runs if run.is_last] == code
    (quiz,) = [index for index in code if is_quiz(cells[index])]
    assert [run.outcome for run in runs if run.index == quiz] == [Outcome.ASKED, Outcome.RIGHT]
    for index in filter(lambda index: is_check(cells[index]), code):
        outcomes = [run.outcome for run in runs if run.index == index]
        assert outcomes == [Outcome.NOT_YET, Outcome.RIGHT], cells[index].source
