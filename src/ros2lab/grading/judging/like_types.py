"""Types of the same shape in another package, such as String of example_interfaces, where those are not installed here."""

from __future__ import annotations

from collections.abc import Iterable

from ros2lab.assignments import Assignment, Part
from ros2lab.grading.evidence import WrittenEnd
from ros2lab.grading.judging.player import STAND_IN


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
