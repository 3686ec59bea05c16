"""What a reader of the grader itself has failed to read: no loss, no gain, and no end of the grade."""

from __future__ import annotations

import sys
from dataclasses import fields, replace
from pathlib import Path

import evidences
import pytest

from ros2lab.diagnose import net
from ros2lab.grading.evidence import Evidence, Files, Heard
from ros2lab.grading.reading import files
from ros2lab.grading.reading.unread import OF_CODE, read_all
from ros2lab.grading.receiving.submission import Submission, receive
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

REFERENCE = Path(__file__).parents[2] / "robot_controller"
FACTS = [one.name for one in fields(Files) if one.name not in ("notes", "unread", "readme", "readme_foreign", "recordings")]  # fmt: skip
WHY = "A rule has failed (KeyError)."


def _broken() -> dict[str, str]:
    raise KeyError("complex")


def _entangled() -> dict[str, str]:
    raise RecursionError


def test_a_reader_that_fails_costs_its_own_fact(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(net.STRICT)
    found, failed = read_all({"setup": _broken, "sources": lambda: {"modules": [1, 1]}})
    assert found == {"sources": {"modules": [1, 1]}}
    assert "KeyError" in failed["setup"]
    assert "not the code's fault" in failed["setup"]


def test_the_tests_see_a_reader_that_fails() -> None:
    with pytest.raises(KeyError):
        read_all({"setup": _broken})


def test_what_nobody_can_follow_is_said_as_before() -> None:
    with pytest.raises(RecursionError):
        read_all({"setup": _entangled})


@pytest.fixture(scope="module")
def received(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Submission, Files]:
    """Return where the reference was received, what it is, and all facts about it."""
    root = tmp_path_factory.mktemp("received") / "alone"
    root.mkdir()
    submission = receive(REFERENCE, root)
    return root, submission, files.look(root, submission)


@pytest.mark.parametrize(
    "name", ["described", "written_ends", "running", "manifest_facts", "findings_of", "declared_in"]
)
def test_files_are_read_but_for_what_fails(
    name: str, monkeypatch: pytest.MonkeyPatch, received: tuple[Path, Submission, Files]
) -> None:
    """All other facts are those that they were, and a note names what is missing."""
    root, submission, whole = received

    def broken(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.delenv(net.STRICT)
    monkeypatch.setattr(files, name, broken)
    some = files.look(root, submission)
    assert some.unread
    different = {one for one in FACTS if getattr(some, one) != getattr(whole, one)}
    assert different <= some.unread.keys()
    assert any("Not read in full: " in note and "not the code's fault" in note for note in some.notes)


@pytest.mark.parametrize("name", FACTS)
def test_a_fact_that_could_not_be_read_costs_nobody_a_point(name: str) -> None:
    """It gives none either: of the bonus nobody has more than was seen."""
    right = evidences.right()
    empty = getattr(Files(), name)
    facts = replace(right.files, **{name: empty}, unread={name: WHY})
    rubric = load()
    before, lost, grade = (
        verdict(given, rubric)
        for given in (right, replace(right, files=replace(facts, unread={})), replace(right, files=facts))
    )
    points = [{one.id: one.points for one in found.criteria} for found in (before, lost, grade)]
    for id_ in points[0]:
        if id_.startswith("bonus"):
            assert points[2][id_] == points[1][id_]
        else:
            assert points[2][id_] == points[0][id_]
    changed = [one for one in grade.criteria if one.points != points[1][one.id]]
    assert all("left to the instructor" in one.reason for one in changed)


def _unread_but_for_a_run(evidence: Evidence) -> Evidence:
    facts = replace(
        evidence.files, ends=[], ends_elsewhere=[], sources={}, unread=dict.fromkeys(OF_CODE, WHY)
    )
    return replace(evidence, files=facts)


@pytest.mark.parametrize(
    ("fault", "lost"),
    [("", 0), ("status: never", 12), ("status: 5 s", 5), ("velocity: once", 3), ("velocity: dies", 3)],
)
def test_a_node_that_was_seen_is_judged_by_what_it_did_where_its_code_was_not_read(
    fault: str, lost: float
) -> None:
    """It is not called one that no code makes; and a large file excuses nothing that was seen."""
    given = evidences.FAULTS[fault][1](evidences.right()) if fault else evidences.right()
    rubric = load()
    before, grade = verdict(given, rubric), verdict(_unread_but_for_a_run(given), rubric)
    points = [{one.id: one.points for one in found.criteria if one.max} for found in (before, grade)]
    parts = [id_ for id_ in points[0] if id_.split(".")[0].endswith(("publisher", "subscriber"))]
    assert [points[1][id_] for id_ in parts] == [points[0][id_] for id_ in parts]
    assert sum(one.max - one.points for one in grade.criteria if one.id in parts) >= lost
    assert points[1]["documentation.code"] == 3


@pytest.mark.parametrize("name", ["numbers_in", "last_word", "is_uneven", "template"])
def test_a_question_that_fails_ends_no_grade(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a node it costs nothing, of the bonus it gives nothing, and the reason says so."""
    rubric, given = load(), evidences.right()
    before = {one.id: one.points for one in verdict(given, rubric).criteria}
    monkeypatch.delenv(net.STRICT)
    for module in (m for n, m in [*sys.modules.items()] if n.startswith("ros2lab.grading.")):
        if hasattr(module, name):
            monkeypatch.setattr(module, name, _fails)
    grade = verdict(given, rubric)
    changed = [one for one in grade.criteria if one.points != before[one.id]]
    assert all("a question of the grader itself has failed" in one.reason for one in changed)
    assert any("a question of the grader itself has failed" in one.reason for one in grade.criteria)
    assert all(one.points <= before[one.id] for one in grade.criteria)


def _fails(*_: object, **__: object) -> bool:
    raise AttributeError("get")


def test_the_tests_see_a_question_that_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ros2lab.grading.questions.publisher.numbers_in", _fails)
    with pytest.raises(AttributeError):
        verdict(evidences.right(), load())


def test_a_judge_that_fails_for_every_node_gives_half_until_the_instructor_decides(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv(net.STRICT)
    monkeypatch.setattr("ros2lab.grading.judging.players.rightful", _fails)
    grade = verdict(evidences.right(), load())
    assert grade.total < 80
    assert grade.components["velocity_publisher"].points == 10


@pytest.mark.parametrize("topic", ["/robot/status", "/cmd_vel", "/answer"])
def test_a_message_that_could_not_be_read_ends_no_grade(topic: str) -> None:
    """One too long after each command is neither the same nor empty, and no field of it is known."""
    given, rubric = evidences.right(), load()
    unread = Heard("std_msgs/msg/String", "", [1.0, 3.0], [{}, {}], 2)
    runs = [
        replace(run, commands=[replace(one, topics={**one.topics, topic: unread}) for one in run.commands])
        for run in given.runs
    ]
    assert verdict(replace(given, runs=runs), rubric).total > 60
