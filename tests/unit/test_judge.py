"""The lessons, the hand-in, the demonstration and the grader say the same of the same record, right or wrong."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from ros2lab import assignments, practices
from ros2lab.checks import CheckError, project
from ros2lab.checks import hand_in as lesson_10
from ros2lab.grading import rubric
from ros2lab.grading.evidence import CommandSeen, Heard, Run
from ros2lab.grading.verdict import verdict
from ros2lab.hand_in import Evidence
from ros2lab.handlers import Handlers
from ros2lab.judge import case_of
from ros2lab.verbs.demo import judge_parts

STATUS, COMMANDS, VELOCITY = assignments.load().parts.values()
ZERO = {"linear": {"x": 0.0, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}}
DRIVING = {**ZERO, "linear": {"x": 0.5, "y": 0.0, "z": 0.0}}


def heard(part: assignments.Part, times: Sequence[float], values: Sequence[Any]) -> dict[str, Heard]:
    return {part.topic: Heard(part.type_name, "/node", [*times], [*values], len(times))}


def statuses(*times: float) -> dict[str, Heard]:
    return heard(STATUS, times, [{"data": "state=idle"}] * len(times))


def velocities(value: Any = ZERO) -> dict[str, Heard]:
    return heard(VELOCITY, [0.1, 0.2, 0.3], [value] * 3)


def obeyed(word: str, line: str = "Received {}", *, moves: bool | None = None) -> CommandSeen:
    value = DRIVING if (word == "start" if moves is None else moves) else ZERO
    return CommandSeen(word, [["INFO", line.format(repr(word))]], velocities(value), {}, True)


def ignored(word: str, value: Any = ZERO) -> CommandSeen:
    return CommandSeen(word, [["WARN", f"No command: {word!r}"]], velocities(value), {}, True)


RIGHT = Run(
    programs=["status", "commands", "velocity"],
    setting="together",
    clock="real",
    nodes=["/status_publisher", "/command_subscriber", "/velocity_publisher"],
    publishes={
        STATUS.topic: {"/status_publisher": [STATUS.type_name]},
        VELOCITY.topic: {"/velocity_publisher": [VELOCITY.type_name]},
    },
    subscribes={COMMANDS.topic: {"/command_subscriber": [COMMANDS.type_name]}},
    qos={},
    parameters={},
    quiet={**statuses(0.1, 2.1, 4.1, 6.1), **velocities()},
    commands=[*map(obeyed, COMMANDS.commands), *map(ignored, COMMANDS.unknown)],
    ended={},
    stopped={},
    notes=[],
    commanded=COMMANDS.topic,
)


def period(seconds: float) -> Run:
    return replace(RIGHT, quiet={**statuses(*(seconds * n for n in range(1, 5))), **velocities()})


def said(*commands: CommandSeen) -> Run:
    return replace(RIGHT, commands=[*commands, *map(ignored, COMMANDS.unknown)])


def typed(part: assignments.Part, kind: str) -> Run:
    ends = {topic: dict(nodes) for topic, nodes in {**RIGHT.publishes, **RIGHT.subscribes}.items()}
    ends[part.topic] = {node: [kind] for node in ends[part.topic]}
    return replace(
        RIGHT,
        publishes={topic: ends[topic] for topic in RIGHT.publishes},
        subscribes={topic: ends[topic] for topic in RIGHT.subscribes},
    )


def elsewhere(topic: str) -> Run:
    return replace(
        RIGHT,
        publishes={topic: RIGHT.publishes[STATUS.topic], VELOCITY.topic: RIGHT.publishes[VELOCITY.topic]},
    )


@dataclass(frozen=True)
class Row:
    """A record, and the parts of which each judge must find something wrong."""

    title: str
    run: Run
    wrong: frozenset[str] = frozenset()


def row(title: str, run: Run, *wrong: assignments.Part) -> Row:
    return Row(title, run, frozenset(part.name for part in wrong))


ROWS = [
    row("all right", RIGHT),
    row("a tenth too slow", period(2.2)),
    row("a tenth too fast", period(1.8)),
    row("a little more than that", period(2.39), STATUS),
    row("twice as often", period(1.0), STATUS),
    row("milliseconds", period(0.002), STATUS),
    row("now and then", replace(RIGHT, quiet={**statuses(0.1, 0.6, 4.0, 4.2), **velocities()}), STATUS),
    row("a single status", replace(RIGHT, quiet={**statuses(0.1), **velocities()}), STATUS),
    row("no status", replace(RIGHT, quiet=velocities()), STATUS),
    row("two at a time", replace(RIGHT, quiet={**statuses(2, 2.001, 4, 4.001, 6, 6.001), **velocities()})),
    row("a status of another type", typed(STATUS, "std_msgs/msg/Int32"), STATUS),
    row("commands of another type", typed(COMMANDS, "std_msgs/msg/Int32"), COMMANDS),
    row("velocities with a header", typed(VELOCITY, "geometry_msgs/msg/TwistStamped"), VELOCITY),
    row("a misspelt topic", elsewhere("/robot/statuss"), STATUS),
    row("stop is not known", said(obeyed("start"), ignored("stop", DRIVING), obeyed("reset")), COMMANDS),
    row("nothing happens", said(*(CommandSeen(w, [], {}, {}, True) for w in COMMANDS.commands)), COMMANDS),
    row(
        "commands that are not logged",
        said(*(replace(obeyed(word), log=[]) for word in COMMANDS.commands)),
        COMMANDS,
    ),
    row(
        "an int in a float field",
        replace(RIGHT, quiet={**RIGHT.quiet, **velocities({**ZERO, "linear": {"x": 5e-324}})}),
        VELOCITY,
    ),
    row(
        "an unknown word sets it in motion",
        replace(
            RIGHT,
            commands=[*map(obeyed, COMMANDS.commands), obeyed("dance", "No command: {}", moves=True)],
        ),
        COMMANDS,
    ),
]


def by_the_lesson(run: Run) -> set[str]:
    node: Any = SimpleNamespace(record=SimpleNamespace(run=lambda: run))
    return {
        part.name for part in (STATUS, COMMANDS, VELOCITY) if refuses(project.expect_nothing_lost, node, part)
    }


def by_the_hand_in(run: Run) -> bool:
    return refuses(lesson_10._expect_nothing_lost, Evidence(Path("EVIDENCE.md"), {}, run=run))


def by_the_demonstration(run: Run) -> set[str]:
    return {expectation.text.partition(":")[0] for expectation in judge_parts(run) if not expectation.is_met}


def by_the_grader(run: Run) -> set[str]:
    grade = verdict(case_of([run]).evidence, rubric.load())
    parts = {criterion.component for criterion in grade.criteria if criterion.points < criterion.max}
    return parts & assignments.load().parts.keys()


def refuses(check: Any, *arguments: Any) -> bool:
    try:
        check(*arguments)
    except CheckError:
        return True
    return False


@pytest.mark.parametrize("case", ROWS, ids=lambda case: case.title)
def test_four_judges_say_the_same(case: Row) -> None:
    """Of the same record each finds the same parts right, and the same wrong."""
    assert by_the_grader(case.run) == case.wrong
    assert by_the_lesson(case.run) == case.wrong
    assert by_the_demonstration(case.run) == case.wrong
    assert by_the_hand_in(case.run) is bool(case.wrong)


@pytest.mark.parametrize(
    ("source", "is_right"),
    [
        ("except ValueError: pass", True),
        ("except (ValueError, KeyError) as error: print(error)", True),
        ("except json.JSONDecodeError: pass", True),
        ("except rclpy.executors.ExternalShutdownException: pass", True),
        ("except: pass", False),
        ("except Exception: pass", False),
        ("except (ValueError, Exception): pass", False),
        ("except BaseException as error: raise", False),
        ("except Every: pass\nEvery = Exception", False),
    ],
)
def test_an_exception_is_caught_by_name_for_all_or_for_none(
    source: str, is_right: bool, tmp_path: Path
) -> None:
    """For the lessons 7 and 10, which count the same practice, and for the grader's facts."""
    text = f"try:\n    run()\n{source}\n"
    package = tmp_path / "src" / practices.PACKAGE / practices.PACKAGE
    package.mkdir(parents=True)
    (package / "node.py").write_text(text)
    counted = practices.places_of_practices(SimpleNamespace(path=tmp_path))[practices.CAUGHT]  # type: ignore[arg-type]
    nodes = [*ast.walk(ast.parse(text))]
    [handler] = [node for node in nodes if isinstance(node, ast.ExceptHandler)]
    assert counted == ["" if is_right else "node.py:3"]
    assert Handlers(nodes).is_by_name(handler) is is_right
