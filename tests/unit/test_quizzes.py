"""Every lesson's questions: what is right passes, what is wrong gets a nudge, and what was chosen is kept."""

from __future__ import annotations

import importlib
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from ros2lab import Progress, course, progress
from ros2lab.checks import CheckError, Praise, Prediction, Question, choices
from ros2lab.checks.choices import Choices, Forecast, Quiz
from ros2lab.widget_state import WIDGET_VIEW

QUESTIONS = (
    Question(
        "What is `$base`?", ("a <b>", "`x`", "it"), "c", "so it is: `it`.", {"a": "no.", "b": "nor that."}
    ),
    Question("And now?", ("yes", "no"), "a", "yes.", {"b": "look again."}),
)
PREDICTION = Prediction("Does it run?", ("yes", "no: `x`"), "b", "It does not: `x`.")


@pytest.fixture(autouse=True)
def work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Give the test a student's folder, and close what it leaves open."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    yield tmp_path
    for widget in list(choices._open.values()):
        widget.close()


@pytest.fixture(params=progress.lessons())
def lesson(request: pytest.FixtureRequest) -> Any:
    """Return the checks of a lesson."""
    return importlib.import_module(f"ros2lab.checks.{request.param}")


def click(widget: Choices, number: Any, letter: Any) -> None:
    """Let a widget receive what the browser sends when "Answer" is clicked."""
    widget._handle_custom_msg({"question": number, "letter": letter}, [])


def test_the_right_letters_pass_in_any_writing(lesson: Any) -> None:
    letters = [question.right for question in lesson.QUIZ]
    assert lesson.quiz(*letters).startswith("Right")
    assert lesson.quiz(*(f" {letter.upper()} " for letter in letters)).startswith("Right")


def test_a_wrong_letter_gets_a_nudge_of_its_own(lesson: Any) -> None:
    right = [question.right for question in lesson.QUIZ]
    nudges = set()
    for number, question in enumerate(lesson.QUIZ):
        assert question.text.endswith(("?", "."))
        assert len(set(question.options)) == len(question.options) >= 3
        assert {question.right, *question.wrong} == set(question.letters)
        assert question.right not in question.wrong
        for letter in question.wrong:
            with pytest.raises(CheckError, match=f"question {number + 1}") as caught:
                lesson.quiz(*right[:number], letter, *right[number + 1 :])
            nudge = caught.value.hints[0]
            assert not re.search(rf"\({question.right}\)", nudge), "it tells the right one"
            nudges.add(nudge)
    assert len(nudges) == sum(len(question.wrong) for question in lesson.QUIZ)


@pytest.mark.parametrize("letters", [("z",), ("a",) * 20, (None, 1, 2), ("", "", "")])
def test_what_is_no_answer_is_told(lesson: Any, letters: tuple[Any, ...]) -> None:
    with pytest.raises(CheckError, match="Not yet"):
        lesson.quiz(*letters)


def test_the_right_clicks_do_the_exercise(lesson: Any) -> None:
    """Also after wrong ones; a cell that is only run does not do it, and looks the same each time."""
    name = lesson.__name__.rpartition(".")[2]
    assert repr(lesson.quiz()) == repr(lesson.quiz())
    quiz = lesson.quiz()
    assert repr(quiz).startswith(f"Quiz: 0 of {len(lesson.QUIZ)} questions answered.\n1. ")
    assert (("quiz", False)) in Progress(name).marks[name]
    for number, question in enumerate(lesson.QUIZ):
        for letter in (*question.wrong, question.right):
            assert not quiz.is_done
            click(quiz, number, letter)
    assert (("quiz", True)) in Progress(name).marks[name]
    assert repr(lesson.quiz()) == repr(lesson.quiz(*(question.right for question in lesson.QUIZ)))


def test_every_lesson_has_exercises_besides() -> None:
    """The order of the lessons is that of the notebooks, and each has its quiz last."""
    for name in progress.lessons():
        exercises = progress.exercises(name)
        assert len(exercises) >= 2, name
        assert exercises[-1] == "quiz", name


def test_a_wrong_choice_gets_its_nudge_and_may_be_made_anew() -> None:
    quiz = Quiz("lesson.quiz", QUESTIONS)
    assert quiz.states[0] == {"tried": "", "is_done": False, "is_right": None, "said": ""}
    click(quiz, 0, "b")
    assert quiz.states[0] == {"tried": "b", "is_done": False, "is_right": False, "said": "Nor that."}
    click(quiz, 0, "c")
    assert quiz.states[0]["is_done"]
    assert re.fullmatch("So it is: <code.*>it</code>.", quiz.states[0]["said"])
    assert not quiz.is_done
    click(quiz, 0, "a")
    assert quiz.states[0]["tried"] == "bc", "what is answered stays"


def test_the_browser_does_not_know_the_answers() -> None:
    """Neither those of a quiz nor what happens is in what it is sent first."""
    for widget in (Quiz("lesson.quiz", QUESTIONS), Forecast("lesson.one", PREDICTION)):
        sent = json.dumps([widget.questions, widget.states])
        assert "So it is" not in sent
        assert "It does not" not in sent
        assert "&lt;b&gt;" in sent or widget.kind == "prediction"


@pytest.mark.parametrize(
    ("number", "letter"), [(0, "z"), (0, ""), (0, None), (9, "a"), (-1, "a"), ("0", "a"), (0, "ab")]
)
def test_what_is_no_choice_changes_nothing(work: Path, number: Any, letter: Any) -> None:
    quiz = Quiz("lesson.quiz", QUESTIONS)
    click(quiz, number, letter)
    quiz._handle_custom_msg("nonsense", [])
    assert [state["tried"] for state in quiz.states] == ["", ""]
    assert not (work / progress.CHOICES).exists()


def test_what_was_chosen_is_shown_again() -> None:
    first = Quiz("lesson.quiz", QUESTIONS)
    click(first, 0, "a")
    click(first, 1, "a")
    second = Quiz("lesson.quiz", QUESTIONS)
    assert second.states == first.states
    assert first.comm is None, "the one that is shown no more is closed"
    assert repr(second).startswith("Quiz: 1 of 2 questions answered.")
    second.close()
    second.close()


@pytest.mark.parametrize(
    "kept", ['{"lesson.quiz": ["z", "c"]}', '{"lesson.quiz": ["c"]}', '{"lesson.quiz": 1}', "x"]
)
def test_what_does_not_fit_the_questions_is_forgotten(work: Path, kept: str) -> None:
    (work / progress.CHOICES).write_text(kept)
    assert Quiz("lesson.quiz", QUESTIONS).states[0]["tried"] == ""


def test_a_prediction_is_made_once_and_then_explained() -> None:
    forecast = Forecast("lesson.one", PREDICTION)
    assert repr(forecast) == "Predict: Does it run?\n   (a) yes\n   (b) no: `x`"
    click(forecast, 0, "a")
    assert forecast.states[0]["is_right"] is False
    assert "It does not" in forecast.states[0]["said"]
    click(forecast, 0, "b")
    again = Forecast("lesson.one", PREDICTION)
    assert again.states[0]["tried"] == "a"
    assert repr(again) == "You expected: yes\nWhat happens: It does not: `x`."
    assert progress.choices() == {"lesson.one": {"chosen": "a", "is_right": False}}


def test_one_on_the_students_own_work_is_neither_right_nor_wrong() -> None:
    forecast = Forecast("lesson.own", PREDICTION._replace(right=None))
    click(forecast, 0, "a")
    assert forecast.states[0]["is_right"] is None
    assert forecast.states[0]["is_done"]


def test_a_reader_without_the_widget_has_texts() -> None:
    """What is no formula is not taken for one, and the answers of a quiz are not told."""
    quiz = Quiz("lesson.quiz", QUESTIONS)._repr_mimebundle_()
    assert set(quiz) == {"text/plain", "text/html", WIDGET_VIEW}
    assert "mathjax_ignore" in quiz["text/html"]
    assert "a &lt;b&gt;" in quiz["text/html"]
    assert "So it is" not in quiz["text/html"]
    assert (
        "<details><summary>What happens"
        in Forecast("lesson.one", PREDICTION)._repr_mimebundle_()["text/html"]
    )


def test_each_prediction_of_a_notebook_has_its_options(lesson: Any) -> None:
    """The names agree, each is asked once, and what happens is among two to four options."""
    name = lesson.__name__.rpartition(".")[2]
    (path,) = (path for path in course.notebooks() if path.stem.partition("_")[2] == name)
    asked = re.findall(r'"check\.predict\(\\"(\w+)\\"\)"', path.read_text(encoding="utf-8"))
    assert asked == list(lesson.PREDICTIONS)
    for prediction in lesson.PREDICTIONS.values():
        assert 2 <= len(set(prediction.options)) == len(prediction.options) <= 4
        assert prediction.right is None or prediction.right in "abcd"[: len(prediction.options)]
        assert "?" in prediction.text
        assert prediction.explanation.rstrip(")").endswith(".")


def test_a_prediction_that_is_none_is_told(lesson: Any) -> None:
    with pytest.raises(ValueError, match="There is no prediction 'x' in this lesson; there are "):
        lesson.predict("x")


def test_praise_is_a_text_and_reads_like_one() -> None:
    praise = Praise("Right: `a` < $b.")
    assert praise == "Right: `a` < $b."
    assert repr(praise) == str(praise)
    shown = praise._repr_html_()
    assert "<b>Right:</b> " in shown
    assert "mathjax_ignore" in shown
    assert "&lt; $b." in shown
