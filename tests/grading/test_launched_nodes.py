"""A launched node is the one that was graded alone, whatever the launch file calls it and its topics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import evidences
import pytest
from evidences import COMMAND, STATUS, VELOCITY

from ros2lab.grading.evidence import Run
from ros2lab.grading.grade import Judgement
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

PATH = f"{evidences.FOLDER}/launch/robot.launch.py"
NEARLY = {"far": "/chatter", "one letter off": "/robot/comand", "of another part": "/robot/status"}


def judged(alone: list[Run], launched: list[Run], named: Mapping[str, list[str]] | None = None) -> Judgement:
    """Return the judgement of a launch file that starts these nodes."""
    given = evidences.right(alone)
    runs = [*alone, evidences.launched(launched)]
    files = replace(given.files, launched_programs={**named} if named else {})
    grade = verdict(replace(given, runs=runs, files=files), load())
    return next(one for one in grade.criteria if one.id == "bonus.launch")


@pytest.mark.parametrize("topic", NEARLY.values(), ids=NEARLY)
@pytest.mark.parametrize(
    ("node", "space"),
    [
        ("/command_subscriber", ""),
        ("/listener", ""),
        ("/lab/command_subscriber", "/lab"),
        ("/lab/ear", "/lab"),
    ],
    ids=["as it is", "renamed", "in a namespace", "renamed in a namespace"],
)
def test_a_node_whose_topic_is_wrong_anyway_is_started(topic: str, node: str, space: str) -> None:
    others = [evidences.status_run(), evidences.velocity_run()]
    alone = [evidences.command_run("/command_subscriber", topic=topic), *others]
    one = judged(alone, [evidences.command_run(node, topic=f"{space}{topic}"), *others])
    assert one.points == one.max, one.reason


def test_a_remapping_may_give_a_node_the_right_topic() -> None:
    others = [evidences.status_run(), evidences.velocity_run()]
    alone = [evidences.command_run(topic="/chatter"), *others]
    one = judged(alone, [evidences.command_run("/ear"), *others])
    assert one.points == one.max, one.reason


def test_a_node_that_is_right_alone_loses_its_topic_by_another_name() -> None:
    others = [evidences.status_run(), evidences.velocity_run()]
    one = judged([evidences.command_run(), *others], [evidences.command_run("/ear", topic="/lab/x"), *others])
    assert one.points == one.max / 2
    assert "nothing is on /robot/command then" in one.reason


@pytest.mark.parametrize("left", [STATUS, COMMAND, VELOCITY])
def test_what_is_not_started_is_missed(left: str) -> None:
    alone = {
        STATUS: evidences.status_run(),
        COMMAND: evidences.command_run(topic="/chatter"),
        VELOCITY: evidences.velocity_run(),
    }
    one = judged([*alone.values()], [run for name, run in alone.items() if name != left])
    assert one.points == one.max / 2
    assert "not seen: " in one.reason


def test_another_node_of_the_same_type_is_not_taken_for_it() -> None:
    others = [evidences.status_run(), evidences.velocity_run()]
    logger = evidences.command_run("/logger", "logger", topic="/diary", log=evidences.echo)
    alone = [evidences.command_run(topic="/robot/comand"), *others, logger]
    one = judged(
        alone, [replace(logger, nodes=["/pen"], subscribes={"/diary": {"/pen": [evidences.STRING]}}), *others]
    )
    assert one.points == one.max / 2, one.reason


def test_a_program_that_the_launch_file_does_not_name_is_not_started() -> None:
    others = [evidences.status_run(), evidences.velocity_run()]
    launched = [evidences.command_run("/ear", topic="/lab/chatter"), *others]
    one = judged([evidences.command_run(topic="/chatter"), *others], launched, {PATH: [STATUS, VELOCITY]})
    assert one.points == one.max / 2, one.reason
