"""A student on a bare Debian goes through every lesson, with wrong answers first and right ones then."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import nbformat
import pytest
from judging import StoredOutputs, what_is_wrong
from lesson_way import is_quiz, way_through

from bare_student import JupyterTerminal, Kernel, Student
from ros2lab import course, progress
from ros2lab.widget_state import WIDGET_VIEW

pytestmark = pytest.mark.long

NOTEBOOKS = course.notebooks()


@pytest.mark.timeout(900)
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_student_gets_through_a_lesson(
    path: Path, student: Student, request: pytest.FixtureRequest
) -> None:
    """Every check refuses the stub and takes the answer, and what is shown is what is stored.

    Nothing else fails, as delivered or answered, and the lesson is done at the end.
    """
    worked = nbformat.read(path, as_version=4).cells
    place = f"notebooks/{path.name}"
    model, kernel = student.open(place)
    delivered = model["content"]["cells"]
    assert [cell["id"] for cell in delivered] == [cell.id for cell in worked]
    runs = way_through(worked)
    stored = StoredOutputs(path, runs, request.session)
    findings = []
    for run in runs:
        cell = delivered[run.index]
        if is_quiz(worked[run.index]) and run.is_answered:
            answer_quiz(path, kernel, cell["outputs"])
        if run.is_answered:
            cell["source"] = worked[run.index].source
        outputs = kernel.run(cell["source"])
        fault = what_is_wrong(run, outputs) or (run.is_last and stored.difference(run.index, outputs))
        if fault:
            findings.append(f"{cell['source']}\n\n{fault}")
        cell["outputs"] = outputs
    student.request("PUT", f"contents/{place}", {**model, "format": "json"})
    kernel.close()
    assert not findings, ("\n" + 100 * "-" + "\n").join(["", *findings])
    assert exercises_to_do(path, student.work) == []


@pytest.mark.timeout(900)
def test_a_terminal_is_in_the_same_world_as_a_notebook(student: Student) -> None:
    """JupyterLab's own terminal has the notebook's home, folder, commands and settings."""
    look = (
        "{ pwd; echo ~; command -v ros2 colcon python3; env | grep -E '^(ROS|RMW|RC|FAST|AMENT)' | sort; } >"
    )
    terminal = JupyterTerminal(student)
    terminal.run(f"{look} ~/seen-in-terminal")
    terminal.close()
    assert (student.work / "seen-in-terminal").exists(), "a terminal's ~ is not the student's folder"
    _, kernel = student.open("notebooks/00_welcome.ipynb")
    outputs = kernel.run("%load_ext ros2lab.terminal")
    outputs += kernel.run(f"%%terminal\n{look} ~/seen-in-notebook")
    kernel.close()
    assert [output for output in outputs if output.output_type == "error"] == []
    seen = (student.work / "seen-in-notebook").read_text(encoding="utf-8")
    assert "/ros2\n" in seen
    assert (student.work / "seen-in-terminal").read_text(encoding="utf-8") == seen


def answer_quiz(path: Path, kernel: Kernel, outputs: list[Any]) -> None:
    """Click the right answers of a quiz, a wrong one before the first."""
    questions = importlib.import_module(f"ros2lab.checks.{path.stem.partition('_')[2]}").QUIZ
    model = outputs[-1]["data"][WIDGET_VIEW]["model_id"]
    kernel.send_to_widget(model, {"question": 0, "letter": min(questions[0].wrong)})
    for number, question in enumerate(questions):
        kernel.send_to_widget(model, {"question": number, "letter": question.right})


def exercises_to_do(path: Path, work: Path) -> list[str]:
    """Return the exercises of a lesson that are not noted as done in a student's folder."""
    lesson = path.stem.partition("_")[2]
    done = json.loads((work / progress.FILE).read_text(encoding="utf-8"))
    return [name for name in progress.exercises(lesson) if f"{lesson}.{name}" not in done]
