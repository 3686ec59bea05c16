"""Whether a period follows a parameter: by what came in each run, also where a busy machine made messages late."""

from __future__ import annotations

from dataclasses import replace

import evidences
import pytest

from ros2lab.grading.evidence import Heard, Run
from ros2lab.grading.judging.periods import is_followed

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
