"""Every check praises right answers in several styles, and refuses wrong ones for their own fault."""

from __future__ import annotations

import importlib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from answering import Answer, StudentsFolder, answers, lessons

from ros2lab import checks, progress
from ros2lab.checks import CheckError
from ros2lab.session import LabSession

LEAST_RIGHT, LEAST_WRONG = 3, 5
NODES_OF_THE_PROJECT = ("status_publisher", "command_subscriber", "velocity_publisher")
LEAST_WRONG_NODES = 12

ANSWERS = [answer for lesson in lessons() for answer in answers(lesson)]
CASES = [pytest.param(answer, marks=pytest.mark.thorough if answer.is_thorough else ()) for answer in ANSWERS]
EXERCISES = [(lesson, name) for lesson in lessons() for name in progress.exercises(lesson) if name != "quiz"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> StudentsFolder:
    """The student's folder, with a space in its path."""
    place = tmp_path_factory.mktemp("student")
    return StudentsFolder(place / "my work", place / "kept")


@pytest.fixture
def student(folder: StudentsFolder, monkeypatch: pytest.MonkeyPatch) -> Iterator[StudentsFolder]:
    """The same, for one answer."""
    monkeypatch.setenv("ROS2LAB_WORK", str(folder.home))
    monkeypatch.setattr(checks, "_failures", {})  # the first hint comes first
    yield folder
    folder.end()
    session = LabSession.current()
    if session is not None:
        session.close()


def said(answer: Answer, student: StudentsFolder) -> str:
    """Type an answer, and return what the check says of it."""
    student.names = {"check": importlib.import_module(f"ros2lab.checks.{answer.lesson}")}
    student.begin(answer.begin)
    student.take(answer.steps)
    return str(eval(answer.call, student.names))


# Both kinds in one list: so neighbours begin alike, and what they begin with is made once.
@pytest.mark.parametrize("answer", CASES, ids=str)
def test_a_right_answer_is_praised_and_a_wrong_one_refused_for_its_own_fault(
    answer: Answer, student: StudentsFolder
) -> None:
    if answer.is_right:
        assert said(answer, student).startswith("Right")
        return
    with pytest.raises(CheckError) as refusal:
        said(answer, student)
    error = refusal.value
    print(error)
    for texts, told in (
        (answer.expected, error.expected),
        (answer.found, error.found),
        (answer.hint, error.hints[0]),
    ):
        for text in texts:
            assert text in told


@pytest.mark.parametrize(("lesson", "exercise"), EXERCISES)
def test_every_exercise_has_answers_of_many_kinds(lesson: str, exercise: str) -> None:
    """Of the wrong ones it is said what the check finds and hints at, and not the same of all."""
    given = [answer for answer in answers(lesson) if answer.exercise == exercise]
    wrong = [answer for answer in given if not answer.is_right]
    is_node = lesson == "robot_controller" and exercise in NODES_OF_THE_PROJECT
    assert len(given) - len(wrong) >= LEAST_RIGHT
    assert len(wrong) >= (LEAST_WRONG_NODES if is_node else LEAST_WRONG)
    assert all(answer.found and answer.hint for answer in wrong)
    assert len({(answer.found, answer.hint) for answer in wrong}) == len(wrong), "two faults are told alike"


def test_every_lesson_has_answers() -> None:
    assert set(lessons()) == set(progress.lessons())


def test_answers_have_titles_of_their_own() -> None:
    titles = Counter(map(str, ANSWERS))
    assert not [title for title, count in titles.items() if count > 1]


def test_a_key_that_means_nothing_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "made_up.yaml").write_text("exercises: {x: {wrong: [{answer: a, finds: b}]}}")
    monkeypatch.setattr("answering.FOLDER", tmp_path)
    with pytest.raises(ValueError, match="finds means nothing here"):
        answers("made_up")
