"""A velocity that only answers every word with the same message is published by whoever speaks, not by its node."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import evidences
import pytest

from ros2lab.grading.evidence import CommandSeen, Run, WrittenEnd
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

WORDS = ("start", "stop", "reset", "rtort", "dance", "start")
TOPIC = "/cmd_vel"
DRIVES, STANDS = evidences.twist(0.5), evidences.twist(0.0)


def run_of(
    after: Sequence[Sequence[Any]],
    before: Sequence[Any] = (),
    apart: float = 4.0,
    words: Sequence[str] = WORDS,
) -> Run:
    """Return a run in which messages come after each of some words, `apart` s after the one before."""
    commands = [
        CommandSeen(
            word,
            [],
            {
                TOPIC: evidences.heard(
                    evidences.TWIST, "/velocity_publisher", [*came], 0.5, 20.0 + apart * number
                )
            }
            if came
            else {},
            {},
            True,
        )
        for number, (word, came) in enumerate(zip(words, after, strict=True))
    ]
    return replace(evidences.velocity_run(values=[*before]), commands=commands)


def reason(run: Run, does: list[str] | None, never: Sequence[str] = ()) -> str | None:
    """Return why the repetition of the velocity loses points; None if it has all.

    Args:
        run: of its program.
        does: what its code does with the words.
        never: what it never does with the velocity.
    """
    evidence = evidences.right([evidences.status_run(), evidences.command_run(), run])
    end = WrittenEnd("/robot/command", evidences.STRING, False, [], evidences.VELOCITY, does)
    out = WrittenEnd(TOPIC, evidences.TWIST, True, [], evidences.VELOCITY, ["publishes"], [*never])
    evidence = replace(evidence, files=replace(evidence.files, ends=[end, out]))
    criteria = verdict(evidence, load()).criteria
    (found,) = [c for c in criteria if c.id == "velocity_publisher.repetition"]
    return None if found.points == found.max else found.reason


@pytest.mark.parametrize("message", [DRIVES, STANDS])
def test_what_echoes_each_word_is_not_published_again_and_again(message: Any) -> None:
    said = reason(run_of([[message]] * len(WORDS)), ["logs"])
    assert said is not None
    assert "only after each word" in said


@pytest.mark.parametrize(
    ("after", "before", "apart"),
    [
        ([[DRIVES]] * 6, [DRIVES, DRIVES], 4.0),
        ([[DRIVES], [STANDS], [STANDS], [STANDS], [STANDS], [DRIVES]], [], 4.0),
        ([[DRIVES], [], [], [], [], [DRIVES]], [], 4.0),
        ([[DRIVES] * 8] * 6, [], 4.0),
        ([[DRIVES], [DRIVES] * 8, [DRIVES], [DRIVES], [DRIVES], [DRIVES]], [], 4.0),
        ([[DRIVES]] * 6, [], 0.01),
    ],
    ids=[
        "also unasked",
        "on each change",
        "only at one word",
        "by a timer since",
        "for a while",
        "too fast to tell",
    ],
)
def test_what_comes_by_itself_or_changes_with_the_word_is(
    after: Sequence[Sequence[Any]], before: Sequence[Any], apart: float
) -> None:
    assert reason(run_of(after, before, apart), ["logs"]) is None


UNKNOWN = ("dance", "twirl")
SAID = ("start", "stop", "reset", *UNKNOWN, "start", *UNKNOWN)
RANDOM = {
    "a length": [
        len(word) for word in ("start", "stop", "reset", "four", "seven77", "start", "four", "seven77")
    ],
    "a sum": [sum(map(ord, word)) % 97 for word in SAID],
    "a count": [number % 5 for number in range(len(SAID))],
    "chance": [0.3, 0.7, 0.1, 0.9, 0.2, 0.8, 0.4, 0.5],
}
TOLD_APART = {
    "its state": [0.5, 0, 0, 0, 0, 0.5, 0.5, 0.5],
    "it stands at others": [0.5, 0, 0.1, 0, 0, 0.5, 0, 0],
    "it turns at others": [0.5, 0, 0.1, 0.3, 0.3, 0.5, 0.3, 0.3],
    "one of them is close": [0.5, 0, 0.1, 0.5, 0, 0.5, 0.5, 0.5],
}


@pytest.mark.parametrize(
    ("speeds", "is_paid"),
    [*((row, False) for row in RANDOM.values()), *((row, True) for row in TOLD_APART.values())],
    ids=[*RANDOM, *TOLD_APART],
)
def test_unknown_words_bring_no_velocities_of_their_own(speeds: Sequence[float], is_paid: bool) -> None:
    """Whatever its code looks at."""
    run = run_of([[evidences.twist(float(speed))] for speed in speeds], words=SAID)
    assert (reason(run, ["reads"]) is None) == is_paid


@pytest.mark.parametrize("does", [["reads"], None])
def test_what_looks_at_the_words_may_know_others(does: list[str] | None) -> None:
    """It stands still at each word that it does not know, and nobody has said one that it knows."""
    assert reason(run_of([[STANDS]] * len(WORDS)), does) is None


def test_what_comes_late_after_very_many_words_does_not_come_by_itself() -> None:
    words = (*WORDS, "1000 x start, stop", "start")
    run = run_of([*[[DRIVES]] * len(WORDS), [], [DRIVES] * 10], words=words)
    assert reason(run, ["logs"]) is not None


def test_what_has_but_one_message_knows_no_word_that_changes_it() -> None:
    run = run_of([[STANDS]] * len(WORDS))
    assert reason(run, ["reads"], never=["varies"]) is not None
