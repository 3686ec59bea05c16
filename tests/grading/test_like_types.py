"""A type of the same name in a package that is not installed here is a near miss, as a topic can be."""

from __future__ import annotations

from dataclasses import replace

import evidences
import pytest

from ros2lab.grading.evidence import Evidence, Run, WrittenEnd
from ros2lab.grading.judging.player import STAND_IN
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

LIKE = "example_interfaces/msg/String"
COMMANDS, STATUS = "/commands", "/robot_state_status"


def _given(run: Run, topic: str, kind: str, *, is_publisher: bool) -> Evidence:
    """Return evidence in which a node was seen with a stand-in for the type that its code has."""
    name = run.programs[0]
    does = ["publishes"] if is_publisher else ["reads"]
    ends = [
        WrittenEnd(topic, kind, is_publisher, [], name, does),
        WrittenEnd("/cmd_vel", evidences.TWIST, True, [0.1], evidences.VELOCITY, ["publishes"]),
    ]
    given = evidences.both(evidences.runs(run), evidences.files(ends=ends, ends_elsewhere=[]))(
        evidences.right()
    )
    assert given.build
    programs = [
        replace(program, absent=["example_interfaces"], modules=[program.name])
        if program.name == name
        else program
        for program in given.build.executables
    ]
    return replace(given, build=replace(given.build, executables=programs))


def _points(given: Evidence, component: str) -> dict[str, float]:
    grade = verdict(given, load())
    return {one.id.rpartition(".")[2]: one.points for one in grade.criteria if one.component == component}


@pytest.mark.parametrize(("kind", "is_found"), [(LIKE, True), ("my_messages/msg/Order", False)])
def test_a_subscriber_is_found_by_a_like_type(kind: str, is_found: bool) -> None:
    """On a topic that is named for commands; the type is wrong, and what cannot be tried costs nothing."""
    run = replace(evidences.command_run(topic=COMMANDS, kind=STAND_IN), commands=[], commanded="")
    points = _points(_given(run, COMMANDS, kind, is_publisher=False), evidences.COMMAND)
    assert points["topic"] == (1 if is_found else 0)
    assert points["type"] == (0.5 if is_found else 0)


@pytest.mark.parametrize(("kind", "is_found"), [(LIKE, True), ("my_messages/msg/State", False)])
def test_a_publisher_is_found_by_a_like_type(kind: str, is_found: bool) -> None:
    run = evidences.status_run(topic=STATUS, kind=STAND_IN)
    points = _points(_given(run, STATUS, kind, is_publisher=True), evidences.STATUS)
    assert (points["topic"] > 0) is is_found
    assert (points["period"] > 0) is is_found
    assert points["type"] == (0.75 if is_found else 0)


@pytest.mark.parametrize("topic", [COMMANDS, STATUS, "/chatter", "/robot_status"])
def test_it_counts_as_the_right_type_does_but_for_the_type(topic: str) -> None:
    like, right = (
        _points(
            _given(evidences.status_run(topic=topic, kind=seen), topic, kind, is_publisher=True),
            evidences.STATUS,
        )
        for seen, kind in ((STAND_IN, LIKE), (evidences.STRING, evidences.STRING))
    )
    assert like == {**right, "type": right["type"] / 4}


@pytest.mark.parametrize("kind", ["", "lab_tools/String"])
def test_a_type_that_nobody_tells_is_not_called_a_wrong_one(kind: str) -> None:
    """Where the program ends for want of the module from which it takes the class, that costs nothing."""
    absent = evidences.without(evidences.STATUS, "TypeError: NotInstalledHere")(evidences.right())
    given = _given(absent.runs[0], "/robot/status", kind, is_publisher=True)
    dead = next(run for run in absent.runs if run.programs == [evidences.STATUS])
    others = [run for run in given.runs if run.programs != [evidences.STATUS] and run.setting == "alone"]
    grade = verdict(replace(given, runs=[dead, *others]), load())
    (found,) = (one for one in grade.criteria if one.id == f"{evidences.STATUS}.type")
    assert (found.points, "has the type" in found.reason) == (found.max, False)
