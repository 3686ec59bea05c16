"""Whether a period follows a parameter: by what came in each run, also where a busy machine made messages late."""

from __future__ import annotations

from dataclasses import replace

import evidences
import pytest

from ros2lab import assignments
from ros2lab.grading.evidence import Clock, CommandSeen, Heard, Run
from ros2lab.grading.judging.periods import is_followed, period_of
from ros2lab.grading.judging.player import Player

TOPIC = "/robot/status"
EVEN = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
LATE_AND_CAUGHT_UP = [0.2, 0.2, 0.4, 0.4, 0.6, 0.6, 0.8, 0.8, 1.0, 1.0]
TWICE_AS_LONG = [0.2, 0.4, 0.6, 0.8, 1.0]
THREE_AT_FIRST = [0.01, 0.02, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
THREE_AT_FIRST_SLOWER = [0.01, 0.02, 0.03, 0.2, 0.4, 0.6, 0.8, 1.0]


def run(times: list[float], setting: str) -> Run:
    whole = evidences.status_run()
    heard = Heard(evidences.STRING, "/status_publisher", times, [{"data": "well"}] * len(times), len(times))
    return replace(whole, setting=setting, quiet={TOPIC: heard})


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        (EVEN, TWICE_AS_LONG, True),
        (THREE_AT_FIRST, THREE_AT_FIRST_SLOWER, True),
        (EVEN, EVEN, False),
        (EVEN, LATE_AND_CAUGHT_UP, False),
        (LATE_AND_CAUGHT_UP, EVEN, False),
    ],
)
def test_only_another_number_of_messages_is_another_period(
    before: list[float], after: list[float], expected: bool
) -> None:
    alone, changed = run(before, "alone"), run(after, "period:=4.0")  # the default is 2.0
    assert is_followed(alone, [changed]) is expected


STATUS = assignments.load().parts["status_publisher"]
# What a timer of 2 s brings where each command takes 2.3 s, and that of one that stands still for two commands.
DELAYED = [[2.3], [4.6], [6.9], [8.2], [10.5], [12.8], [14.0, 16.1], [18.4]]
PAUSED = [[2.3], [4.6], [6.9], [8.2], [10.5], [], [], [18.4], [20.7], [22.0, 24.1], [26.3]]
ANSWERED = [[2.3], [4.6], [6.9], [9.2], [11.5]]
ANSWERED_TWICE = [[2.3, 2.3], [4.6, 4.6], [6.9, 6.9], [9.2, 9.2]]


def after_commands(times: list[list[float]], clock: Clock, first: list[float]) -> Player:
    """Return a status publisher that says something after each command, at these times, and at others before."""

    def said(at: list[float]) -> dict[str, Heard]:
        values = [{"data": "well"}] * len(at)
        return {TOPIC: Heard(evidences.STRING, "/status_publisher", at, values, len(at))} if at else {}

    commands = [CommandSeen("start", [], said(at), {}, True) for at in times]
    heard = replace(evidences.status_run(), clock=clock, quiet=said(first), commands=commands)
    return Player(
        STATUS, "right", TOPIC, "/status_publisher", (evidences.STRING,), 0, heard, "status_publisher"
    )


@pytest.mark.parametrize(
    ("times", "clock", "first", "expected"),
    [
        (DELAYED, "stepped", [], 2.0),
        (PAUSED, "stepped", [], 2.0),
        (ANSWERED, "stepped", [], None),
        (ANSWERED, "stepped", [0.1], None),
        (ANSWERED_TWICE, "stepped", [], None),
        (ANSWERED, "stepped", [2.0, 4.0, 6.0], 2.0),
        ([[2.3, 3.3], [4.3, 5.3], [6.3, 7.3]], "stepped", [], 1.0),
        ([[], [4.0], [], [], [6.0], []], "real", [2.0], 2.0),
        ([[2.0], [4.0], [6.0]], "real", [], None),
    ],
)
def test_the_rhythm_of_the_commands_is_nobodys_period(
    times: list[list[float]], clock: Clock, first: list[float], expected: float | None
) -> None:
    found = period_of(after_commands(times, clock, first))
    assert found == (None if expected is None else pytest.approx(expected, abs=0.05))
