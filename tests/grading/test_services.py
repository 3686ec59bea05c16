"""What is asked of services: evidence made by hand, a row each, and the answer that it must get."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from evidences import right

from ros2lab import assignments
from ros2lab.grading.evidence import Evidence, Run, ServiceCall
from ros2lab.grading.evidence_json import evidence_json, read_evidence
from ros2lab.grading.grade import Judgement
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

LAMP = Path(__file__).parents[2] / "docs/examples/lamp"
ASSIGNMENT = assignments.load(LAMP)
RUBRIC = load(LAMP / "rubric.yaml", ASSIGNMENT)
SERVICE, TYPE = "/lamp/switch", "std_srvs/srv/SetBool"
RESPONSES: list[Any] = [dict(exchange.response) for exchange in ASSIGNMENT.parts["switch"].requests]
AGAIN = {"success": True, "message": "on"}
LAST = "Traceback (most recent call last):\nZeroDivisionError: division by zero"


def evidence(
    responses: list[Any],
    *,
    name: str = SERVICE,
    kind: str = TYPE,
    seconds: float = 0.01,
    again: Any = AGAIN,
    dead: bool = False,
) -> Evidence:
    """Return the evidence of one program with these responses; None is none, and the last one if it died of it."""
    requests = [dict(exchange.request) for exchange in ASSIGNMENT.parts["switch"].requests]
    calls = [
        ServiceCall(name, request, response, seconds, False, not (dead and number == len(responses) - 1))
        for number, (request, response) in enumerate(zip(requests, responses, strict=False))
    ]
    calls += [] if dead or not responses else [ServiceCall(name, requests[0], again, seconds, True, True)]
    run = Run(
        ["lamp"], "alone", "stepped", ["/lamp"], {}, {}, {}, {}, {}, [], {"lamp": LAST} if dead else {}, {}, [],
        services={name: {"/lamp": [kind]}}, calls=calls,
    )  # fmt: skip
    return replace(right([run]), assignment="lamp", runs=[run])


def judged(seen: Evidence) -> dict[str, Judgement]:
    assert read_evidence(evidence_json(seen)) == seen
    return {one.id: one for one in verdict(seen, RUBRIC).criteria if one.component == "switch"}


WRONG = {"success": False, "message": "on"}
# What is seen, and the criteria that lose points, with the share that is left and a part of the reason.
ROWS: dict[str, tuple[Evidence, dict[str, tuple[float, str]]]] = {
    "all right": (evidence(RESPONSES), {}),
    "one wrong": (
        evidence([WRONG, *RESPONSES[1:]]),
        {"answers": (0.5, "{data: true} was answered with {success: false}, not with {success: true}")},
    ),
    "all wrong": (evidence([{}, {}, {}]), {"answers": (0, "No response of /lamp/switch is right")}),
    "late": (
        evidence(RESPONSES, seconds=1.5),
        {"answers": (0, "was answered after 1.5 s, not within 1 s")},
    ),
    "deaf at last": (evidence(RESPONSES, again=None), {"life": (0, "does not answer another request")}),
    "dies of the second request": (
        evidence([RESPONSES[0], None], dead=True),
        {"life": (0, "lamp ended by itself with “ZeroDivisionError: division by zero”")},
    ),
    "dies of the first request": (
        evidence([None], dead=True),
        {"answers": (0, "the first request ended its program"), "life": (0, "ended by itself")},
    ),
    "another type": (
        evidence([], kind="std_srvs/srv/Trigger"),
        {
            "type": (0, "/lamp/switch has the type std_srvs/srv/Trigger"),
            "answers": (0, "as a std_srvs/srv/Trigger it could not be called"),
            "life": (0.5, "the node that is meant for /lamp/switch has another type"),
        },
    ),
    "nearly its name": (
        evidence(RESPONSES, name="/lamp/swich"),
        {"name": (0.4, "/lamp provides the service /lamp/swich, not /lamp/switch")},
    ),
    "another name": (
        evidence(RESPONSES, name="/toggle"),
        {"name": (0.2, "/lamp provides the service /toggle, not /lamp/switch")},
    ),
}


@pytest.mark.parametrize("row", ROWS)
def test_what_is_seen_of_a_service_is_worth(row: str) -> None:
    seen, losses = ROWS[row]
    criteria = judged(seen)
    assert {
        id_.partition(".")[2] for id_, one in criteria.items() if one.points < one.max
    } == losses.keys(), [one.reason for one in criteria.values()]
    for name, (share, reason) in losses.items():
        one = criteria[f"switch.{name}"]
        assert one.points == pytest.approx(share * one.max)
        assert reason in one.reason
        assert one.hint


def test_where_there_is_no_service_nothing_is_earned() -> None:
    seen = evidence([])
    seen = replace(seen, runs=[replace(seen.runs[0], services={}, nodes=[])])
    for one in judged(seen).values():
        assert one.points == 0
        assert one.reason.startswith("No node that provides the service /lamp/switch was seen")
