"""The lesson, the hand-in, the demonstration and the grader watch the same package in their own ways, and agree."""

from __future__ import annotations

from pathlib import Path

import pytest

from ros2lab import assignments, course, hand_in
from ros2lab.checks import CheckError, robot_controller
from ros2lab.grading import rubric
from ros2lab.grading.collect import collect
from ros2lab.grading.verdict import verdict
from ros2lab.judge import case_of, lost
from ros2lab.verbs.demo import judge_lives, judge_parts
from ros2lab.workspace import Workspace

# The lesson's assessment and the grader are compared in each run, in test_hand_in.py.
pytestmark = [pytest.mark.long, pytest.mark.thorough]

PARTS = assignments.load().parts
# Of the reference: right, though not exactly; ended by a word that it does not know; on another topic.
CHANGES = {
    "status_publisher": ('"period", 2.0', '"period", 2.1'),
    "command_subscriber": ("except ValueError as error:", "except KeyError as error:"),
    "velocity_publisher": ('"cmd_vel"', '"cmd_velocity"'),
}
WRONG = {"command_subscriber", "velocity_publisher"}


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Workspace:
    """A student's workspace with a changed reference package."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path / "student"))
    copy = course.copy_reference(tmp_path / "student", has_tests=False)
    for module, (old, new) in CHANGES.items():
        path = copy / "src/robot_controller/robot_controller" / f"{module}.py"
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new))
    return Workspace(copy)


def test_four_judges_agree(workspace: Workspace) -> None:
    """The parts that are wrong are so for all four, and the one that is right is right for all."""
    collected = hand_in.collect_evidence(workspace)
    assert collected.run is not None
    case = case_of([collected.run])
    ended = {name for name, end in collected.programs.items() if end != hand_in.RUNS}
    assert {part for part in PARTS if lost(case, part)} | ended == WRONG
    unmet = [
        expectation.text
        for expectation in (*judge_parts(collected.run), *judge_lives(collected.run))
        if not expectation.is_met
    ]
    assert {text.partition(":")[0] for text in unmet} & {*PARTS} | ended == WRONG
    assert "every node runs until Ctrl-C" in unmet
    assert {part for part in PARTS if is_refused(part)} == WRONG
    grade = verdict(collect(workspace.path, lambda _: None), rubric.load())
    criteria = (criterion for criterion in grade.criteria if criterion.points < criterion.max)
    assert {criterion.component for criterion in criteria} & {*PARTS} == WRONG


def is_refused(part: str) -> bool:
    """Return whether the lesson's check of a node finds something wrong."""
    try:
        getattr(robot_controller, part)()
    except CheckError:
        return True
    return False
