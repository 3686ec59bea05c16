"""Which nodes may play a part whose topic nobody has: those of its type that do what it is for, also on another part's topic."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import NamedTuple

from ros2lab.assignments import Assignment, Part
from ros2lab.diagnose.sources.spelling import is_near_topic
from ros2lab.grading.evidence import Evidence, Run, WrittenEnd
from ros2lab.grading.judging.player import STAND_IN, Match, Player, is_busy, stamped
from ros2lab.grading.judging.reactions import effects_of, is_followed
from ros2lab.rhythm import between, has_period


class Candidate(NamedTuple):
    """A node that may play a part, by one of its topics in a run."""

    part: Part
    topic: str
    node: str
    run: Run


def owners_of(assignment: Assignment, topic: str) -> list[Part]:
    """Return the parts that have a topic, or nearly that one."""
    parts = assignment.parts.values()
    return [part for part in parts if topic == part.topic or is_near_topic(topic, part.topic)]


def rightful(found: Mapping[str, Iterable[Player]]) -> set[tuple[str, str]]:
    """Return the parts of which a node with the right type was heard, each with the topic."""
    return {
        (name, player.topic)
        for name, players in found.items()
        for player in players
        if player.part.type_name in player.types and player.is_heard
    }


def without_intruders(
    found: Mapping[str, Iterable[Player]], taken: Collection[tuple[str, str]]
) -> dict[str, list[Player]]:
    """Return the players by part, without those of a wrong type on the topics that others have taken rightly."""
    return {
        name: [
            player
            for player in players
            if (name, player.topic) not in taken or player.part.type_name in player.types
        ]
        for name, players in found.items()
    }


def match_by_type(
    assignment: Assignment, part: Part, topic: str, types: Collection[str], taken: Collection[tuple[str, str]]
) -> Match | None:
    """Return how a topic of a part's type fits, if nobody has the part's own topic; None if its name tells what it is.

    On another part's topic a node is misplaced if it cannot be that part's: it has the other end of the topic, or
    another type while that part has its own node there, as `taken` tells.
    """
    owners = owners_of(assignment, topic)
    if part.type_name not in types or part in owners:
        return None
    for owner in owners:
        if owner.end == part.end and (owner.type_name in types or (owner.name, topic) not in taken):
            return None
    return "misplaced" if owners else "unnamed"


def is_alike(evidence: Evidence, assignment: Assignment, candidate: Candidate) -> bool:
    """Return whether more than a type shared by several parts tells that a node plays a part.

    A publisher has the right period, or publishes repeatedly and plays no other part. A subscriber reacts
    to commands when it is alone, and it tells them apart or the code compares with one of them; or it plays no other
    part, and what it listens to is nobody else's topic.
    """
    part, topic, node, run = candidate
    if assignment.is_only(part):
        return True
    is_owned = bool(owners_of(assignment, topic))
    if not is_owned and assignment.meant_by(topic) not in (part, None):
        return False  # the topic is named for another part
    if part.is_publisher:
        times = run.quiet[topic].times if topic in run.quiet else []
        gaps = between(times)
        is_known, is_done = any(has_period(gap, part.period) for gap in gaps), bool(gaps)
    else:
        own = [
            heard
            for heard in evidence.runs
            if heard.setting == "alone"
            and heard.commanded == topic
            and node in heard.subscribes.get(topic, ())
        ]
        is_done = any(is_followed(heard, {}) for heard in own)
        is_known = is_done and (
            not {*evidence.files.compared}.isdisjoint(part.commands)
            or any("processed" in effects_of(part, heard, {}, has_own_log=True).values() for heard in own)
        )
        is_done &= not is_owned
    return is_known or (is_done and not is_busy(assignment, part, node, run, topic))


def with_like_types(
    types: Iterable[str], topic: str, ends: Iterable[WrittenEnd], assignment: Assignment
) -> list[str]:
    """Return a topic's types, and for a stand-in the type of the assignment that has the name of the one in the code.

    So a node is found by it as by a topic that is nearly right; its type is wrong all the same.
    """
    types = [*types]
    if STAND_IN not in types:
        return types
    there = [end for end in ends if end.topic == topic]
    parts = assignment.parts.values()
    like = (part.type_name for part in parts if any(is_like_type(end, part) for end in there))
    return [*types, *dict.fromkeys(like)]


def is_like_type(end: WrittenEnd, part: Part) -> bool:
    """Return whether the type of an end in the code has the name of a part's type."""
    return end.type_name.rpartition("/")[2] == part.short_type


def may_end(end: WrittenEnd, part: Part) -> bool:
    """Return whether an end that the code makes may belong to a part."""
    types = ("", part.type_name, stamped(part.type_name))
    is_like = end.type_name in types or is_like_type(end, part) or is_near_topic(end.topic, part.topic)
    return end.is_publisher is part.is_publisher and (is_like or end.topic == part.topic)
