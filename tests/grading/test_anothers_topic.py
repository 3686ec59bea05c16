"""A node on another part's topic is judged for its own part, and takes nothing from the one that is right there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import evidences
import pytest
from evidences import COMMAND, STATUS, STRING, TWIST, VELOCITY

from ros2lab.grading.evidence import Evidence, Run
from ros2lab.grading.grade import Grade
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

TOPICS = {STATUS: "/robot/status", COMMAND: "/robot/command", VELOCITY: "/cmd_vel"}
RUNS: dict[str, Callable[..., Run]] = {
    STATUS: evidences.status_run,
    COMMAND: evidences.command_run,
    VELOCITY: evidences.velocity_run,
}
MISPLACED = [(part, owner) for part in TOPICS for owner in TOPICS if part != owner]


def together(alone: list[Run]) -> Run:
    """Return what is seen of programs that run together, where nobody listens to a topic of several types."""
    publishes: dict[str, dict[str, list[str]]] = {}
    for run in alone:
        for topic, nodes in run.publishes.items():
            publishes.setdefault(topic, {}).update(nodes)
    run = replace(evidences.merged(alone, ""), publishes=publishes)
    quiet = {topic: heard for topic, heard in run.quiet.items() if topic not in run.torn}
    programs = [name for other in alone for name in other.programs]
    return replace(run, programs=programs, setting="together", quiet=quiet)


def graded(runs: dict[str, Run]) -> Grade:
    """Grade a hand-in with these runs of single programs, also together and without a launch file."""
    alone = [*runs.values()]
    given = evidences.right(alone)
    plain = [run for run in given.runs if run.setting != "launched"]
    return verdict(replace(given, runs=[*plain, together(alone)]), load())


def points(grade: Grade) -> dict[str, float]:
    return {part: grade.components[part].points for part in TOPICS}


def own_runs() -> dict[str, Run]:
    return {part: run() for part, run in RUNS.items()}


@pytest.mark.parametrize(("part", "owner"), MISPLACED)
def test_a_node_on_anothers_topic_loses_its_topic_only(part: str, owner: str) -> None:
    grade = graded(own_runs() | {part: RUNS[part](topic=TOPICS[owner])})
    near = graded(own_runs() | {part: RUNS[part](topic=f"{TOPICS[part]}s")})
    assert points(grade) == pytest.approx({**points(graded(own_runs())), part: points(grade)[part]})
    assert 15 <= points(grade)[part] <= points(near)[part]
    told = next(one for one in grade.criteria if one.id == f"{part}.topic")
    assert f"{TOPICS[owner]}, not {TOPICS[part]}: that is the topic of {owner}" in told.reason
    assert told.hint == f"Name the topic {TOPICS[part]}."


@pytest.mark.parametrize(("part", "owner"), MISPLACED)
@pytest.mark.parametrize("faulty", TOPICS)
def test_one_more_right_thing_beside_it_never_costs(part: str, owner: str, faulty: str) -> None:
    faults = {
        STATUS: evidences.status_run(period=0.5),
        COMMAND: evidences.command_run(log=evidences.echo),
        VELOCITY: evidences.velocity_run(values=[evidences.twist("nan")] * 10),
    }
    misplaced = {part: RUNS[part](topic=TOPICS[owner])}
    without = {name: run for name, run in own_runs().items() if name != faulty} | misplaced
    steps = [without, own_runs() | {faulty: faults[faulty]} | misplaced, own_runs() | misplaced, own_runs()]
    totals = [sum(points(graded(runs)).values()) for runs in steps]
    assert totals == sorted(totals)


@pytest.mark.parametrize("kind", ["std_msgs/msg/Float32", STRING])
def test_a_further_node_of_another_type_takes_nothing_from_a_right_one(kind: str) -> None:
    teleop = evidences.velocity_run("/teleop", "teleop", kind=kind, values=[{"data": 1.0}])
    grade = graded(own_runs() | {"teleop": teleop})
    assert points(grade) == points(graded(own_runs()))
    told = [note for note in grade.notes if note.startswith("Nodes use /cmd_vel with several types")]
    assert len(told) == 1
    assert TWIST in told[0]
    assert kind in told[0]


def test_a_listener_on_anothers_topic_that_does_nothing_plays_no_part() -> None:
    deaf = evidences.command_run(topic="/cmd_vel", log=lambda _text: [])
    assert points(graded(own_runs() | {COMMAND: deaf}))[COMMAND] == 0


def test_one_node_does_not_count_twice() -> None:
    """A text on the velocity's topic is a velocity of the wrong type, where nobody else publishes one."""
    runs = {COMMAND: evidences.command_run(), STATUS: evidences.status_run(topic="/cmd_vel")}
    assert points(graded(runs))[STATUS] == 0
    assert 0 < points(graded(runs))[VELOCITY] < 10


def test_what_could_not_be_listened_to_is_not_silent() -> None:
    """A program whose topic has two types is not shut out because the run of all of them brings nothing there."""
    alone = [*(own_runs() | {COMMAND: evidences.command_run(topic="/cmd_vel")}).values()]
    seen = together(alone)
    assert "/cmd_vel" in seen.torn
    assert "/cmd_vel" not in seen.quiet
    assert "/robot/status" in seen.quiet
    given: Evidence = evidences.right(alone)
    grade = verdict(replace(given, runs=[*alone, seen]), load())
    assert grade.components[VELOCITY].points == 20
