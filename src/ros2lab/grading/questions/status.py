"""The node that publishes a status every 2 s."""

from __future__ import annotations

import itertools
import statistics

from ros2lab.grading.questions import nodes
from ros2lab.grading.questions.answer import Answer, question, shown
from ros2lab.grading.roles import STATUS, Case, Part

AT_A_TIME = 0.05  # of the longest time between two messages
UNEVEN = 1.5  # s, between two times from message to message; on a busy machine one can be late
# Between which periods a level lies, in s, both ends included and after rounding to 0.1 s; all others are far off.
LEVELS = (("right", 1.8, 2.2), ("close", 1.5, 2.5), ("off", 1.0, 4.0))


@question("right doubled near other missing", "topic node why", nodes.CODES | nodes.TOPIC_CODES)
def status_topic(case: Case) -> Answer:
    """Whether a node publishes on /robot/status."""
    return nodes.topic(case, STATUS)


@question("right wrong missing", "type topic", nodes.CODES | nodes.TYPE_CODES)
def status_type(case: Case) -> Answer:
    """Whether the status is a String."""
    answer = nodes.type_(case, STATUS)
    return (
        Answer("wrong", answer.seen, answer.evidence, answer.place) if answer.level == "stamped" else answer
    )


@question(
    "right close off far irregular growing once silent missing",
    "period topic",
    nodes.CODES | frozenset(("period",)),
)
def status_period(case: Case) -> Answer:
    """Whether the status comes every 2 s: as the node says it, or as a launch file with its parameters does."""
    parts = [part for part in case.parts[STATUS] if part.is_heard and not _is_other(case, part)]
    if not case.parts[STATUS]:
        return Answer("missing", {"period": "", "topic": ""}, ("runs",))
    best = (parts or case.parts[STATUS])[0]
    seen = {"period": "", "topic": shown(best.topic)}
    found = [(part, period) for part in parts if (period := period_of(part)) is not None]
    alone = [one for one in found if one[0].run.setting == "alone"]
    uneven = next((part for part, _ in alone or found if _is_uneven(part)), None)
    growing = next((part for part, _ in found if _is_growing(case, part)), None)
    if growing:
        return Answer("growing", seen, (growing.quiet_key,), shown(growing.topic))
    if uneven:
        return Answer("irregular", seen, (uneven.quiet_key,), shown(uneven.topic))
    if found:
        part, period = min(alone or found, key=lambda one: _level(one[1])[0])
        if not _is_right(period):
            part, period = next((one for one in found if _is_steady(one[0])), (part, period))
        rounded = round(period, 1)
        seen = {"period": f"{rounded:.1f}" if rounded else "less than 0.1", "topic": shown(part.topic)}
        return Answer(_level(period)[1], seen, (part.quiet_key,), seen["topic"])
    total = max((sum(heard.count for heard in part.heard) for part in parts), default=0)
    level = "silent" if not total else "once" if total == 1 else "irregular"
    return Answer(level, seen, (best.quiet_key,), seen["topic"])


def _is_other(case: Case, part: Part) -> bool:
    """Return whether the node has other parameters in this run than alone, and its period is not right for that."""
    own = part.run.parameters.get(part.node)
    values = [one.run.parameters.get(one.node) for one in case.parts[STATUS] if one.run.setting == "alone"]
    is_changed = bool(own) and any(value and value != own for value in values)
    return is_changed and not _is_steady(part)


def _is_uneven(part: Part) -> bool:
    """Return whether the times between messages differ before any command."""
    gaps = _quiet_gaps(part)
    return len(gaps) > 1 and max(gaps) - min(gaps) > UNEVEN


def _is_growing(case: Case, part: Part) -> bool:
    """Return whether several come where one came before, and the code makes one more timer whenever one fires."""
    gaps = _between(_quiet_times(part))
    makes_more = any(code == "timer-in-callback" for code, *_ in case.evidence.files.findings)
    return makes_more and part.run.clock == "real" and bool(gaps) and min(gaps) < max(gaps) / 4


def _is_steady(part: Part) -> bool:
    """Return whether all times between two messages of a run are right."""
    return all(map(_is_right, _gaps(part)))


def _is_right(period: float) -> bool:
    return _level(period)[1] == "right"


def _quiet_gaps(part: Part) -> list[float]:
    """Return the times between the messages that came before any command, in s."""
    return _apart(_between(_quiet_times(part)))


def _quiet_times(part: Part) -> list[float]:
    quiet = part.run.quiet.get(part.topic)
    return quiet.times if quiet else []


def _gaps(part: Part) -> list[float]:
    """Return the times between all messages that came in a run, in s."""
    return _apart(_between([time for heard in part.heard for time in heard.times]))


def _between(times: list[float]) -> list[float]:
    return [later - earlier for earlier, later in itertools.pairwise(times)]


def _apart(gaps: list[float]) -> list[float]:
    """Return the times between messages without those between several at a time."""
    return [gap for gap in gaps if gap > AT_A_TIME * max(gaps)]


def _level(period: float) -> tuple[int, str]:
    """Return how far a period, in s, is off: a number for it, and its level."""
    for number, (level, least, most) in enumerate(LEVELS):
        if least <= round(period, 1) <= most:
            return number, level
    return len(LEVELS), "far"


@question("lives dies ends stops silent missing", "program last", nodes.CODES)
def status_goes_on(case: Case) -> Answer:
    """Whether the node lives and goes on publishing."""
    return nodes.life(case, STATUS)


def period_of(part: Part) -> float | None:
    """Return the time between two messages, in s, before any command if it is seen there; None if it is not seen."""
    gaps = _quiet_gaps(part) or _gaps(part)
    return statistics.median(gaps) if gaps else None
