"""What is asked of parameters: evidence made by hand, a row each, and the answer that it must get."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from evidences import heard, right

from ros2lab import assignments
from ros2lab.grading.evidence import Clock, Run
from ros2lab.grading.evidence_json import EvidenceError, evidence_json, read_evidence
from ros2lab.grading.grade import Judgement
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

LAMP = Path(__file__).parents[2] / "docs/examples/lamp"
RUBRIC = load(LAMP / "rubric.yaml", assignments.load(LAMP))
TOPIC, TYPE = "/lamp/light", "std_msgs/msg/String"
HELD = {"period": 1.0, "name": "lamp"}
NO_NAME = {"period": 1.0}
DIED = "Traceback (most recent call last):\nrclpy.exceptions.InvalidParameterTypeException: it is a double"


def run(
    setting: str,
    texts: list[str],
    period: float = 1.0,
    *,
    held: dict[str, Any] = HELD,
    clock: Clock = "stepped",
    end: str = "",
) -> Run:
    quiet = {} if end else {TOPIC: heard(TYPE, "/lamp", [{"data": text} for text in texts], period)}
    return Run(
        ["lamp"], setting, clock, ["/lamp"], {TOPIC: {"/lamp": [TYPE]}}, {}, {}, {"/lamp": held}, quiet, [],
        {"lamp": end} if end else {}, {}, [],
    )  # fmt: skip


def judged(runs: list[Run]) -> Judgement:
    seen = replace(right(runs[:1]), assignment="lamp", runs=runs)
    return next(one for one in verdict(seen, RUBRIC).criteria if one.id == "light.parameters")


SAME, OTHER = ["lamp: off"] * 3, ["kitchen: off"] * 3
ALONE, AGAIN = run("alone", SAME), run('name:="lamp"', SAME)
FASTER, NAMED = run("period:=0.5", SAME, 0.5), run('name:="kitchen"', OTHER)
COUNTED = ["lamp 1", "lamp 2", "lamp 3"]
LATER = ["lamp 2", "lamp 3", "lamp 4"]
# What was seen, the share that it earns, and a part of the reason.
ROWS: dict[str, tuple[list[Run], float, str]] = {
    "both": ([ALONE, FASTER, NAMED, AGAIN], 1, "With another value for period and name"),
    "no rhythm": ([ALONE, run("period:=0.5", SAME), NAMED, AGAIN], 0.5, "period:=0.5."),
    "no message": ([ALONE, FASTER, run('name:="kitchen"', SAME), AGAIN], 0.5, 'name:="kitchen".'),
    "neither": ([ALONE, run("period:=0.5", SAME), run('name:="kitchen"', SAME), AGAIN], 0, "period:=0.5 and name"),
    "it dies of it": (
        [ALONE, run("period:=0.5", [], end=DIED), NAMED, AGAIN],
        0.5,
        "period:=0.5, with which it ended by “rclpy.exceptions",
    ),
    "not declared": (
        [run("alone", SAME, held=NO_NAME), run("period:=0.5", SAME, 0.5)],
        0.5,
        "name, which no such node declares",
    ),
    "none declared": ([run("alone", SAME, held={})], 0, "has a parameter period and name"),
    "the value that it has": (
        [run("alone", OTHER, held={**HELD, "name": "kitchen"}), FASTER, NAMED],
        0.5,
        'name:="kitchen", which is what it has by itself',
    ),
    "chance in each message": (
        [run("alone", ["a", "b"]), FASTER, run('name:="kitchen"', ["c", "d"]), run('name:="lamp"', ["e", "f"])],
        0.5,
        'name:="kitchen".',
    ),
    "a count that is heard later": (
        [
            run("alone", COUNTED, clock="real"),
            run("period:=0.5", COUNTED, 0.5, clock="real"),
            run('name:="kitchen"', LATER, clock="real"),
            run('name:="lamp"', COUNTED, clock="real"),
        ],
        0.5,
        'name:="kitchen".',
    ),
    "a count": (
        [
            run("alone", COUNTED),
            FASTER,
            run('name:="kitchen"', ["kitchen 1", "kitchen 2"]),
            run('name:="lamp"', COUNTED),
        ],
        1,
        "",
    ),
}  # fmt: skip


@pytest.mark.parametrize("row", ROWS)
def test_what_is_seen_of_parameters_is_worth(row: str) -> None:
    runs, share, reason = ROWS[row]
    criterion = judged(runs)
    assert criterion.points == pytest.approx(share * criterion.max), criterion.reason
    assert reason in criterion.reason
    assert bool(criterion.hint) is (share < 1)


def test_the_evidence_of_declared_parameters_is_read_again() -> None:
    seen = right()
    declared = {"period": 1.0, "name": "lamp", "is_on": True, "other": None}
    seen = replace(seen, files=replace(seen.files, declared=declared))
    assert read_evidence(evidence_json(seen)) == seen
    text = evidence_json(seen).replace('"name": "lamp"', '"name": ["lamp"]')
    with pytest.raises(
        EvidenceError, match=r"declared\.name must be true or false or a number or a text or null"
    ):
        read_evidence(text)
