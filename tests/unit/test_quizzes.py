"""Every lesson's quiz: the right letters pass, each wrong one gets a nudge that does not tell the right one."""

from __future__ import annotations

import importlib
import re
from pathlib import Path
from typing import Any

import pytest

from ros2lab import progress
from ros2lab.checks import CheckError


@pytest.fixture(params=progress.lessons())
def lesson(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return the checks of a lesson, in a student's folder of the test's own."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    return importlib.import_module(f"ros2lab.checks.{request.param}")


def test_the_right_letters_pass_in_any_writing(lesson: Any) -> None:
    letters = [question.right for question in lesson.QUIZ]
    assert lesson.quiz(*letters).startswith("Right")
    assert lesson.quiz(*(f" {letter.upper()} " for letter in letters)).startswith("Right")


def test_a_wrong_letter_gets_a_nudge_of_its_own(lesson: Any) -> None:
    right = [question.right for question in lesson.QUIZ]
    nudges = set()
    for number, question in enumerate(lesson.QUIZ):
        assert len(question.wrong) >= 2
        assert question.right not in question.wrong
        for letter in question.wrong:
            with pytest.raises(CheckError, match=f"question {number + 1}") as caught:
                lesson.quiz(*right[:number], letter, *right[number + 1 :])
            nudge = caught.value.hints[0]
            assert not re.search(rf"\({question.right}\)", nudge), "it tells the right one"
            nudges.add(nudge)
    assert len(nudges) == sum(len(question.wrong) for question in lesson.QUIZ)


@pytest.mark.parametrize("letters", [(), ("z",), ("a",) * 20, (None, 1, 2), ("", "", "")])
def test_what_is_no_answer_is_told(lesson: Any, letters: tuple[Any, ...]) -> None:
    with pytest.raises(CheckError, match="Not yet"):
        lesson.quiz(*letters)


def test_every_lesson_has_exercises_besides() -> None:
    """The order of the lessons is that of the notebooks, and each has its quiz last."""
    for name in progress.lessons():
        exercises = progress.exercises(name)
        assert len(exercises) >= 2, name
        assert exercises[-1] == "quiz", name
