"""Commands are said again behind words that nobody knows: what answers their place, and not the word, is no answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import evidences
import pytest

from ros2lab import assignments
from ros2lab.grading.evidence import CommandSeen, Heard, Run
from ros2lab.grading.judging.told_again import told_by_place
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict
from ros2lab.grading.watching.script import Script

COURSE = assignments.load().with_coined_words("a hand-in")
assert COURSE.commanded is not None
PART, SCRIPT = COURSE.commanded, Script(COURSE.commanded)
AGAIN = (SCRIPT.first, *SCRIPT.few)
COINED = [word for word in PART.unknown if word not in assignments.load().commanded.unknown]  # type: ignore[union-attr]

# What a node says when a text comes: log lines, and what it publishes on /robot/state.
Node = Callable[[str], tuple[list[str], list[str]]]


def _story(answers: list[tuple[list[str], list[str]]]) -> Node:
    coming = iter(answers)
    return lambda _: next(coming, ([], []))


def told(first: str, more: str = "") -> Node:
    """Tell a story, and say of all else that it is not known, or nothing."""
    parts = [([f"now {state}"], [state]) for state in ("one", "two", "three")]
    rest = ([more] if more else [], [])
    until_again = SCRIPT.all.index(PART.commands[0], 1) - len(parts)
    return _story([*parts, *[rest] * until_again, parts[0], rest] if first else [([], []), *parts])


def silent_story() -> Node:
    """Tell it on a topic alone."""
    return _story([([], ["one"]), ([], ["two"]), ([], ["three"])])


def log_words() -> Node:
    return lambda text: ([f"{text}: done" if text in PART.commands else f"unknown: {text}"], [])


def tell_state() -> Node:
    """Say the state whatever comes."""
    states = ["idle"]

    def hear(text: str) -> tuple[list[str], list[str]]:
        states.append({"start": "moving", "stop": "idle", "reset": "idle"}.get(text, states[-1]))
        return [f"the robot is {states[-1]}"], []

    return hear


def publish_changes() -> Node:
    states = [""]

    def hear(text: str) -> tuple[list[str], list[str]]:
        states.append({"start": "moving", "stop": "still", "reset": "ready"}.get(text, states[-1]))
        return [], [states[-1]] if states[-1] != states[-2] else []

    return hear


def count() -> Node:
    """Number what comes, and obey."""
    numbers = iter(range(100))
    return lambda text: ([f"{next(numbers)}: {text if text in PART.commands else 'ignored'}"], [])


def _run(node: Node, texts: tuple[str, ...], setting: str, late: int = 0) -> Run:
    """Let a node hear texts; what it says after each comes so many commands late."""
    said: list[tuple[list[str], list[str]]] = [([], [])] * late
    for text in texts:
        words = text.split(", ") if text == SCRIPT.first else [text]
        answers = [node(word) for word in words]
        said.append(
            ([line for lines, _ in answers for line in lines], [s for _, sent in answers for s in sent])
        )
    commands = [
        CommandSeen(
            text,
            [["INFO", line] for line in lines],
            {"/robot/state": Heard(evidences.STRING, "/x", [0.0] * len(sent), [{"data": one} for one in sent], len(sent))}
            if sent
            else {},
            {},
            True,
        )
        for text, (lines, sent) in zip(texts, said, strict=False)
    ]  # fmt: skip
    run = evidences.command_run(setting=setting)
    return replace(run, commands=commands)


STORIES: dict[str, Callable[[], Node]] = {
    "refuses all else": lambda: told("first", "Unknown command"),
    "is silent then": lambda: told("first"),
    "tells by a topic": silent_story,
}
HONEST = {one.__name__: one for one in (log_words, tell_state, publish_changes, count)}


@pytest.mark.parametrize("name", STORIES)
def test_a_story_that_is_told_whatever_comes_is_no_answer(name: str) -> None:
    make = STORIES[name]
    runs = [_run(make(), SCRIPT.all, "alone"), _run(make(), AGAIN, "launched")]
    assert told_by_place(PART, runs, {}) == {*PART.commands}


@pytest.mark.parametrize("late", [0, 1])
@pytest.mark.parametrize("name", HONEST)
def test_an_answer_follows_its_word_wherever_it_comes(name: str, late: int) -> None:
    """Also where all of them come late, in the one run."""
    make = HONEST[name]
    runs = [_run(make(), SCRIPT.all, "alone"), _run(make(), AGAIN, "launched", late)]
    assert told_by_place(PART, runs, {}) == set()


def test_what_is_launched_may_say_it_otherwise_or_not_at_all() -> None:
    """By its parameters, or for a level of its log; and it may be dead by then."""
    alone = _run(log_words(), SCRIPT.all, "alone")
    otherwise = _run(lambda text: ([f"robot 1 heard {text}"], []), AGAIN, "launched")
    mute = _run(lambda _: ([], []), AGAIN, "launched")
    dead = replace(mute, commands=[replace(mute.commands[0], is_alive=False)])
    for again in (otherwise, mute, dead):
        assert told_by_place(PART, [alone, again], {}) == set()


def test_an_answer_may_be_missing_where_a_program_has_ended() -> None:
    """The node of the commands dies of an unknown word; another node goes on to say in which state it began."""
    alone = _run(tell_state(), SCRIPT.all, "alone")
    ended = _run(lambda _: ([], []), AGAIN, "launched")
    first, *others = ended.commands
    said_on = replace(first, log=[["INFO", "the robot is idle"]], is_alive=False)
    ended = replace(ended, commands=[said_on, *(replace(one, is_alive=False) for one in others)])
    begun = replace(alone, log=[["INFO", "the robot is idle"]])
    assert told_by_place(PART, [begun, ended], {}) == set()
    assert told_by_place(PART, [alone, ended], {}) == {"stop", "reset"}  # if nobody says so before


def test_a_story_earns_nothing_for_commands() -> None:
    """Neither that they are processed, nor that they are logged."""
    points = []
    for make in (STORIES["refuses all else"], log_words):
        alone, again = _run(make(), SCRIPT.all, "alone"), _run(make(), AGAIN, "launched")
        right = evidences.right([evidences.status_run(), alone, evidences.velocity_run()])
        launched = next(run for run in right.runs if run.setting == "launched")
        runs = [run for run in right.runs if run is not launched]
        runs.append(replace(launched, commands=again.commands))
        grade = verdict(replace(right, runs=runs, coined=COINED), load())
        points.append(grade.components["command_subscriber"].points)
    assert points == [10, 20]


def test_the_words_before_are_always_the_same_for_a_hand_in() -> None:
    """And others for another one; no command is among them."""
    course = assignments.load()
    words = [course.with_coined_words(text).commanded for text in ("one", "one", "two", "three", "four")]
    before = [part.before for part in words if part]
    assert before[0] == before[1]
    assert len({*before}) == 4
    assert all(len(part) >= len(PART.commands) and {*PART.commands}.isdisjoint(part) for part in before)
    assert course.of_plain(COURSE.plain()) == COURSE
