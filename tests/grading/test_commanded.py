"""What a command earns that shows in nothing, or only in a line that unknown words have, too."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import evidences
import pytest
from evidences import COMMAND, TWIST, VELOCITY

from ros2lab.grading.evidence import Evidence, Run
from ros2lab.grading.grade import Judgement
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

WORDS = ("start", "stop", "reset")
DRIVES = {"start": 0.5, "stop": 0.0, "reset": 0.0}


def judged(evidence: Evidence, criterion: str) -> Judgement:
    return next(one for one in verdict(evidence, load()).criteria if one.id == f"{COMMAND}.{criterion}")


def silent(_text: str) -> list[str]:
    return []


def driving(log: evidences.Reaction, speeds: Mapping[str, float], before: float) -> list[Run]:
    """Return the runs of a program that takes commands and drives, at a speed before any command."""
    quiet = {"/cmd_vel": evidences.heard(TWIST, "/robot", [evidences.twist(before)] * 5, 0.1)}
    run = evidences.command_run("/robot", VELOCITY, log=log)
    start = {"": before} if before else {}
    return [
        evidences.status_run(),
        replace(evidences.moving(run, {**start, **speeds}, node="/robot"), quiet=quiet),
    ]


@pytest.mark.parametrize(
    ("log", "known", "before", "points"),
    [
        # reset comes when stop has done what both do
        (silent, WORDS, 0.0, 6),
        (evidences.echo, WORDS, 0.0, 6),
        (silent, ("start", "stop"), 0.0, 3),
        (evidences.echo, ("start", "stop"), 0.0, 3),
        (evidences.echo, ("start", "stop", "rest"), 0.0, 3),
        # it drives from the beginning
        (silent, WORDS, 0.5, 6),
        (evidences.echo, ("stop", "reset"), 0.5, 3),
        # where reading misses the words that are obeyed, a line in the log shows that the others came, too
        (evidences.echo, (), 0.0, 6),
        (silent, (), 0.0, 3),
        # what is warned of like unknown words is not known, whatever else compares with it
        (lambda text: [] if text in ("start", "stop") else ["unknown"], WORDS, 0.0, 3),
    ],
)  # fmt: skip
def test_what_brings_about_what_is_so_already_is_believed_by_the_code(
    log: evidences.Reaction, known: Sequence[str], before: float, points: float
) -> None:
    evidence = evidences.right(driving(log, DRIVES, before))
    one = judged(evidences.files(depended_on=[*known], compared=[*known])(evidence), "commands")
    assert one.points == points, one.reason


def test_a_node_that_shows_nothing_is_not_believed_by_its_code_alone() -> None:
    evidence = evidences.runs(evidences.command_run(log=silent))(evidences.right())
    assert judged(evidences.files(depended_on=[*WORDS])(evidence), "commands").points == 0


@pytest.mark.parametrize(
    ("log", "points"),
    [
        (lambda text: [] if text in WORDS else ["bad command"], 0),
        (lambda text: ["bad command"] if text == "START" or text not in WORDS else [], 0),
        (lambda text: [] if text else ["an empty one"], 0),
        (lambda text: ["a long one"] if len(text) > 5 else [], 0),
        (lambda text: ["Go"] if text == "START" else [], 2),
        (lambda _text: ["A command came"], 2),
        (lambda text: ["\u200b" * len(text)], 0),
        (lambda text: [" " * len(text)], 0),
        (lambda text: [f"\x1b[8m{text}\x1b[0m"], 0),
        (lambda text: [f"ok{' ' * len(text)}"], 2),
        (lambda text: [f"It is {text}\u200b"], 4),
    ],
)
def test_a_line_after_an_unknown_word_is_none_after_a_command(log: evidences.Reaction, points: float) -> None:
    one = judged(
        evidences.runs(evidences.moving(evidences.command_run(log=log), DRIVES))(evidences.right()), "log"
    )
    assert one.points == points, one.reason


def by_branch(*branches: str) -> Callable[[str], list[str]]:
    """Return the log of a node that has a line for each of these words, and one for all others."""
    return lambda text: [
        f"I do {branches.index(text.lower())}" if text.lower() in branches else "I am at home"
    ]


@pytest.mark.parametrize(
    ("log", "commands", "points"),
    [
        (by_branch("start", "stop"), 3, 4),
        (by_branch("start", "reset"), 3, 4),
        (by_branch("start"), 1.5, 4),
        (by_branch("start", "stop", "reset"), 6, 4),
        (lambda text: ["Go"] if text == "start" else ["Halt"] if text == "stop" else [], 3, 2),
        (lambda _text: ["I am at home"], 0, 2),
    ],
)
def test_a_command_without_a_branch_of_its_own_is_charged_once(
    log: evidences.Reaction, commands: float, points: float
) -> None:
    evidence = evidences.runs(evidences.command_run(log=log))(evidences.right())
    assert judged(evidence, "commands").points == commands
    one = judged(evidence, "log")
    assert one.points == points, one.reason


@pytest.mark.parametrize(
    ("branches", "points"),
    [
        ({}, {"log": 4, "robustness": 4}),
        ({"stop": ["mute"]}, {"log": 2, "robustness": 4}),
        ({"start": ["mute", "last"]}, {"log": 4, "robustness": 4}),
        ({"reset": ["last"]}, {"log": 4, "robustness": 0}),
    ],
)
def test_of_a_command_that_was_not_said_that_is_believed_which_its_branch_has(
    branches: dict[str, list[str]], points: Mapping[str, float]
) -> None:
    run = evidences.command_run(texts=("start",))
    given = evidences.right([evidences.status_run(), run, evidences.velocity_run()])
    given = evidences.files(depended_on=[*WORDS], compared=[*WORDS], branches=branches)(given)
    assert {name: judged(given, name).points for name in points} == points


@pytest.mark.parametrize(
    ("known", "words", "points"),
    [
        (("start",), ("start",), {"commands": 1.5, "log": 2}),
        (("start", "stop"), ("start",), {"commands": 3, "log": 2}),
        (WORDS, ("start",), {"commands": 6, "log": 4}),
        ((), ("start",), {"commands": 6, "log": 4}),
        (("go",), ("start",), {"commands": 6, "log": 4}),
    ],
    ids=[
        "none of them",
        "one of them",
        "all",
        "reading finds none",
        "reading misses the one that was obeyed",
    ],
)
def test_a_command_that_was_not_said_is_believed_by_the_code(
    known: Sequence[str], words: Sequence[str], points: Mapping[str, float]
) -> None:
    """A node that sleeps at the first one leaves no time for the others, whether or not it knows them."""
    run = evidences.command_run(texts=(*words,))
    given = evidences.right([evidences.status_run(), run, evidences.velocity_run()])
    given = evidences.files(depended_on=[*known], compared=[*known])(given)
    assert {name: judged(given, name).points for name in points} == points
