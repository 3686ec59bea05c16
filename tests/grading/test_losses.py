"""What a report says first: each reason for lost points once, however many criteria it costs."""

from __future__ import annotations

import evidences
import pytest

from ros2lab.grading.grade import Judgement
from ros2lab.grading.overrides import Decision
from ros2lab.grading.reports.losses import losses
from ros2lab.grading.reports.markdown import markdown
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

GONE = "Fix first why the node was not seen."
ENDS = {"with an error": "Traceback (most recent call last):\nKeyError: 'left'", "without a word": ""}


def _told(change: evidences.Change, component: str) -> list[Judgement]:
    grade = verdict(change(evidences.right()), load())
    return next(loss.criteria for loss in losses(grade) if loss.component == component)


@pytest.mark.parametrize("name", evidences.NODES)
@pytest.mark.parametrize("how", ENDS)
def test_a_node_that_was_not_seen_is_told_once(name: str, how: str) -> None:
    """With all of its points, the fullest reason, and each hint once."""
    told = _told(evidences.without(name, ENDS[how]), name)
    assert len(told) == 1
    assert told[0].max - told[0].points == 20
    assert told[0].reason.startswith("No node that ")
    assert f"{name} ended with" in told[0].reason
    assert told[0].hint == GONE


def test_what_a_missing_node_needs_is_still_told() -> None:
    """Where nothing explains it, each criterion's hint says another part of what to write."""
    given = evidences.right([evidences.status_run(), evidences.velocity_run()])
    grade = verdict(given, load())
    told = next(loss.criteria for loss in losses(grade) if loss.component == evidences.COMMAND)
    assert len(told) == 1
    assert all(word in told[0].hint for word in ("subscription", "msg.data", "get_logger", "spin"))
    assert (
        markdown(grade).count("No node that subscribes to `/robot/command` was seen") == 1 + 5
    )  # all criteria


def test_other_reasons_stay_apart() -> None:
    run = evidences.status_run(topic="/robot_status", period=2.3)
    told = _told(evidences.runs(run), evidences.STATUS)
    assert [criterion.id for criterion in told] == ["status_publisher.topic", "status_publisher.period"]


def test_what_an_instructor_decided_stands_by_itself() -> None:
    given = evidences.without(evidences.STATUS, "KeyError: 'left'")(evidences.right())
    decision = Decision(points=1, comment="It ran in the lab.", by="I. Structor")
    grade = verdict(given, load(), {"status_publisher.type": decision})
    told = next(loss.criteria for loss in losses(grade) if loss.component == evidences.STATUS)
    assert [criterion.override is not None for criterion in told] == [False, True]
    assert sum(criterion.max - criterion.points for criterion in told) == 19
