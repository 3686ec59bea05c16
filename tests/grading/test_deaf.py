"""What counts for the commands comes from a program that tells them apart, if one does."""

from __future__ import annotations

from dataclasses import replace

import evidences
import pytest
from evidences import COMMAND, TWIST, VELOCITY, Reaction

from ros2lab.grading.evidence import Evidence, Run
from ros2lab.grading.rubric import Rubric, load
from ros2lab.grading.verdict import verdict

COMMANDS = [f"command_subscriber.{name}" for name in ("topic", "type", "commands", "log", "robustness")]


@pytest.fixture(scope="module")
def rubric() -> Rubric:
    return load()


def _nothing(_text: str) -> list[str]:
    return []


def _always(_text: str) -> list[str]:
    return ["Something came"]


def _driver(log: Reaction) -> Run:
    """Return a run of the driver that takes the commands itself, and drives after the first."""
    taken = evidences.command_run("/velocity_publisher", VELOCITY, log=log)
    speed, commands = 0.0, []
    for command in taken.commands:
        word = command.text.strip().lower()
        speed = {"start": 0.5, "stop": 0.1, "reset": 0.0}.get(word, speed)
        heard = evidences.heard(TWIST, "/velocity_publisher", [evidences.twist(speed)] * 3, 0.1)
        commands.append(replace(command, topics={"/cmd_vel": heard}))
    own = evidences.velocity_run(values=[evidences.twist(0.0)] * 10)
    return replace(own, subscribes=taken.subscribes, commands=commands, commanded=taken.commanded)


def _handed(log: Reaction, *others: Run) -> Evidence:
    return evidences.right([evidences.status_run(), evidences.command_run(log=log), *others])


def _points(evidence: Evidence, rubric: Rubric) -> dict[str, float]:
    return {one.id: one.points - one.max for one in verdict(evidence, rubric).criteria}


@pytest.mark.parametrize("deaf", [_nothing, _always])
@pytest.mark.parametrize("log", [_nothing, evidences.log_by_word])
def test_a_deaf_node_is_not_played_by_the_driver(rubric: Rubric, deaf: Reaction, log: Reaction) -> None:
    """Its executable does nothing that it is named for; the driver that obeys plays two parts."""
    lost = _points(_handed(deaf, _driver(log)), rubric)
    assert lost["package.executables"] < 0
    assert lost["velocity_publisher.topic"] < 0
    assert (lost["command_subscriber.log"] < 0) == (log is _nothing)


@pytest.mark.parametrize("log", [evidences.log_by_word, evidences.echo])
def test_a_driver_that_hears_the_commands_takes_nothing_from_the_node_that_tells_of_them(
    rubric: Rubric, log: Reaction
) -> None:
    lost = _points(_handed(log, _driver(_nothing)), rubric)
    assert {name for name in COMMANDS if lost[name]} == set()
    assert not lost["package.executables"]
    assert not lost["velocity_publisher.topic"]


def test_a_deaf_node_alone_is_judged_by_itself(rubric: Rubric) -> None:
    lost = _points(_handed(_nothing, evidences.velocity_run()), rubric)
    assert lost["command_subscriber.commands"] == -6
    assert not lost["package.executables"]


def test_a_node_that_dies_of_a_command_is_not_played_by_the_driver_either(rubric: Rubric) -> None:
    run = evidences.command_run(log=_nothing)
    dead = replace(
        run, commands=[replace(run.commands[0], is_alive=False)], ended={COMMAND: "KeyError: 'start'"}
    )
    given = evidences.right([evidences.status_run(), dead, _driver(evidences.log_by_word)])
    assert _points(given, rubric)["velocity_publisher.topic"] < 0


def test_a_node_of_any_name_may_play_the_part(rubric: Rubric) -> None:
    """What nothing is named for costs nothing: here the recorder is deaf, and plays no part."""
    recorder = evidences.command_run("/recorder", "recorder", log=_nothing)
    given = _handed(evidences.log_by_word, evidences.velocity_run(), recorder)
    assert {name for name, lost in _points(given, rubric).items() if lost} == set()
