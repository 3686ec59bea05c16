"""What is done is kept in the student's folder, and a check's hints come one after the other."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path

import pytest

from deadlines import DEADLINE
from ros2lab import Progress, checks, course, progress
from ros2lab.checks import CheckError, Question, exercise, graded
from ros2lab.side_bar.server import course_progress

QUIZ = (
    Question(
        "Why?", ("1", "2", "3"), "b", "Because it is so.", {"a": "Look again.", "c": "Nobody does that."}
    ),
    Question("Is it?", ("yes", "no"), "a", "Yes.", {"b": "No."}),
)


@pytest.fixture(autouse=True)
def work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give the test a student's folder."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path / "work"))
    monkeypatch.setattr(checks, "_failures", {})
    return tmp_path / "work"


def test_a_success_is_kept_and_shown(work: Path) -> None:
    @exercise
    def first() -> str:
        return "Right."

    @exercise
    def second() -> str:
        raise CheckError("a", "b", "c")

    lesson = first.__module__.rpartition(".")[2]
    assert first() == "Right."
    with pytest.raises(CheckError):
        second()
    assert list(progress.read()) == [f"{lesson}.first"]
    assert (work / ".ros2lab").is_file(), "the folder is known for the student's"


def test_the_lesson_and_the_whole_course_are_shown() -> None:
    progress.keep("drive_the_robot.turn_radius")
    assert "✔ turn_radius  done" in repr(Progress("drive_the_robot"))
    whole = Progress()
    assert whole.marks["drive_the_robot"][0] == ("turn_radius", True)
    assert "○ 00 welcome" in repr(whole)
    assert "<td" in whole._repr_html_()


def test_the_whole_course_links_its_lessons_and_names_the_next_one() -> None:
    for name in progress.exercises("welcome"):
        progress.keep(f"welcome.{name}")
    page = Progress()._repr_html_()
    assert [f'href="{path.name}"' in page for path in course.notebooks()] == [True] * 11
    assert 'Next: <a href="01_workspaces.ipynb">01 workspaces</a>' in page
    assert 'value="2" aria-label="2 of 2 done"' in page
    for lesson in progress.lessons():
        for name in progress.exercises(lesson):
            progress.keep(f"{lesson}.{name}")
    assert Progress().next_lesson is None
    assert "Next:" not in Progress()._repr_html_()


@pytest.mark.parametrize("lesson", progress.lessons())
def test_the_exercises_in_the_source_are_those_that_a_lesson_offers(lesson: str) -> None:
    module = importlib.import_module(f"ros2lab.checks.{lesson}")
    offered = {
        name
        for name, value in vars(module).items()
        if getattr(value, "__module__", None) == module.__name__
        and ((hasattr(value, "__wrapped__") and not name.startswith("_")) or name == "quiz")
    }
    assert set(progress.exercises(lesson)) == offered


def test_the_side_bar_is_told_what_is_done_and_what_comes_next() -> None:
    answer = course_progress()
    assert [lesson["path"] for lesson in answer["lessons"]] == [
        f"notebooks/{path.name}" for path in course.notebooks()
    ]
    assert {lesson["done"] for lesson in answer["lessons"]} == {0}
    assert answer["next"] == "notebooks/00_welcome.ipynb"
    for lesson in progress.lessons():
        for name in progress.exercises(lesson):
            progress.keep(f"{lesson}.{name}")
    answer = course_progress()
    assert all(lesson["done"] == lesson["count"] > 1 for lesson in answer["lessons"])
    assert answer["next"] is None


@pytest.mark.parametrize("text", ["", "nonsense", "[1, 2]", "\x00", "[" * 100_000])
def test_a_broken_file_does_no_harm(work: Path, text: str) -> None:
    work.mkdir()
    (work / progress.FILE).write_text(text)
    assert progress.read() == {}
    progress.keep("lesson.one")
    assert list(progress.read()) == ["lesson.one"]
    assert (work / "earlier" / f"{progress.FILE}-1").read_text() == text, "it may be of use to somebody"


def test_a_folder_that_cannot_be_written_does_not_spoil_the_check(work: Path) -> None:
    work.parent.joinpath("work").write_text("a file, where the folder should be")

    @exercise
    def good() -> str:
        return "Right."

    assert good() == "Right."


def test_two_kernels_lose_nothing_of_one_another(work: Path) -> None:
    code = (
        "import sys; from ros2lab import progress; print(flush=True); sys.stdin.readline();"
        "[progress.keep(f'{sys.argv[1]}.{number}') for number in range(40)]"
    )
    kernels = [
        subprocess.Popen(
            [sys.executable, "-c", code, name], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        for name in ("one", "two", "three")
    ]
    for kernel in kernels:
        assert kernel.stdout is not None
        kernel.stdout.readline()  # it is ready
    for kernel in kernels:
        assert kernel.stdin is not None
        kernel.stdin.write("go\n")
        kernel.stdin.flush()
    for kernel in kernels:
        kernel.communicate(timeout=DEADLINE)
        assert kernel.returncode == 0
    assert len(progress.read()) == 120


def test_hints_come_one_after_the_other() -> None:
    @exercise
    def hard() -> str:
        raise CheckError("a", "b", "think", "look there", "type that")

    hints = []
    for _ in range(4):
        with pytest.raises(CheckError) as caught:
            hard()
        hints.append(str(caught.value).partition("Hint: ")[2])
    assert hints == ["think", "look there", "type that", "type that"]


def test_a_new_fault_begins_with_its_own_first_hint() -> None:
    """Also when the first one comes back."""

    @exercise
    def hard(fault: str) -> str:
        raise CheckError("a", "b", f"first of {fault}", f"second of {fault}")

    hints = []
    for fault in ("x", "x", "y", "x", "x"):
        with pytest.raises(CheckError) as caught:
            hard(fault)
        hints.append(str(caught.value).partition("Hint: ")[2])
    assert hints == ["first of x", "second of x", "first of y", "first of x", "second of x"]


def test_predictions_are_counted_once_one_is_made(work: Path) -> None:
    """One on which nothing is right or wrong does not count."""
    assert "prediction" not in repr(Progress("welcome")) + Progress("welcome")._repr_html_()
    progress.keep_prediction("welcome.one", "a", is_right=True)
    progress.keep_prediction("welcome.two", "b", is_right=False)
    progress.keep_prediction("welcome.open", "c", is_right=None)
    progress.keep_prediction("colcon.one", "c", is_right=True)
    assert repr(Progress("welcome")).endswith("\n1 of 2 predictions was right.")
    assert "<p>1 of 2 predictions was right.</p>" in Progress("welcome")._repr_html_()
    assert repr(Progress()).endswith("\n2 of 3 predictions were right.")


@pytest.mark.parametrize(
    "text", ["", "[1]", '{"welcome.one": 1, "welcome.two": {}, "welcome.x": {"is_right": 3}}']
)
def test_broken_choices_do_no_harm(work: Path, text: str) -> None:
    work.mkdir()
    (work / progress.CHOICES).write_text(text)
    assert "prediction" not in repr(Progress("welcome"))
    progress.keep_choices("welcome.quiz", ["a", "", "c"])
    assert progress.choices()["welcome.quiz"] == ["a", "", "c"]


def test_a_quiz_says_why() -> None:
    assert graded(QUIZ, ["b", " A "]) == "Right. (1) Because it is so. (2) Yes."


@pytest.mark.parametrize(
    ("letters", "said"),
    [
        (("a", "a"), "Look again"),
        (("c", "a"), "Nobody does that"),
        (("b", "b"), "question 2"),
        (("x", "a"), "the letters are a, b, c"),
        (("b",), "2 letters"),
        ((), "2 letters"),
        ((1, None), "the letters are"),
    ],
)
def test_a_wrong_answer_gets_a_nudge(letters: tuple[str, ...], said: str) -> None:
    with pytest.raises(CheckError, match=said):
        graded(QUIZ, letters)
