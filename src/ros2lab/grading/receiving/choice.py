"""Which of several packages is graded, and which others may play the parts that it does not."""

from __future__ import annotations

import ast
import difflib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import PurePosixPath

from ros2lab.assignments import Assignment, Part
from ros2lab.diagnose import net
from ros2lab.diagnose.nodes.topic_faults import End, ends_of, timers_of
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.spelling import is_near_miss
from ros2lab.grading.code.compared import compared
from ros2lab.grading.code.running import running
from ros2lab.grading.receiving.notes import Kind
from ros2lab.rhythm import has_period

# What counts for a package: that colcon builds it, as much as a topic, and that it lies in a workspace's src.
BUILDABLE, IN_SRC = 2, 4
_LONGEST_TOPIC = 100  # characters


@dataclass(frozen=True)
class Candidate:
    """A package that may be the assignment's.

    Attributes:
        folder: where it lies.
        name: its name.
        is_built: whether colcon builds its executables as the assignment asks.
        workspace: the folder in whose src it lies; None if there is none.
        sources: its Python files that have to do with ROS or the assignment.
        assignment: the assignment that it may be for.
    """

    folder: PurePosixPath
    name: str
    is_built: bool
    workspace: str | None
    sources: Sequence[PythonSource]
    assignment: Assignment

    @property
    def likeness(self) -> float:
        """How much it looks like the assignment's: by content, by whether colcon builds it, and by place."""
        return self.content + BUILDABLE * self.is_built + IN_SRC * (self.workspace is not None)

    @property
    def content(self) -> float:
        """How much of the assignment is in it; the name counts up to 3."""
        name = self.name[:_LONGEST_TOPIC].lower()
        return self.work + 3 * difflib.SequenceMatcher(None, name, self.assignment.package).ratio()

    @cached_property
    def work(self) -> int:
        """How much of the assignment is in its code.

        A topic counts 2, or 1 if it is misspelt; a part with a publisher or subscription of the right type,
        and a command that something is compared with, count 1 each; an import of rclpy counts 2.
        """
        imports_rclpy = any(
            found.target.partition(".")[0] == "rclpy" for source in self.sources for found in source.imports
        )
        of_right_type = sum(any(self._ends_like(part)) for part in self.assignment.parts.values())
        compares = sum(len({*part.commands} & self._compared) for part in self.assignment.parts.values())
        return sum(self._topics.values()) + of_right_type + compares + 2 * imports_rclpy

    @cached_property
    def plays(self) -> frozenset[str]:
        """The parts that its code clearly plays: by topic, by a type that no other part has, or by period."""
        return frozenset(
            part.name
            for part in self.assignment.parts.values()
            if part.topic.lstrip("/") in self._topics
            or any(self.assignment.is_only(part) or _has_rhythm(part, end) for end in self._ends_like(part))
        )

    @cached_property
    def may_play(self) -> frozenset[str]:
        """The parts that it plays, and those for which it has an end of the right type, on whatever topic."""
        parts = self.assignment.parts.values()
        return self.plays | {part.name for part in parts if any(self._ends_like(part))}

    @cached_property
    def _topics(self) -> dict[str, int]:
        """The assignment's topics in its strings: 2 for one that is right, 1 for one that is misspelt."""
        strings = (
            node.value for source in self.sources for node in source.nodes if isinstance(node, ast.Constant)
        )
        words = {text.strip("/") for text in strings if isinstance(text, str) and len(text) < _LONGEST_TOPIC}
        found = {}
        for topic in (topic.lstrip("/") for topic in self.assignment.topics):
            if any(f"/{word}".endswith(f"/{topic}") for word in words):
                found[topic] = 2
            elif any(is_near_miss(word, topic) for word in words):
                found[topic] = 1
        return found

    @cached_property
    def _ends(self) -> list[End]:
        try:
            return ends_of(NodeSources({source.shown: source for source in self.sources}), unnamed=True)
        except Exception as error:
            net.unjudged(error)  # its topics say enough about a package
            return []

    @cached_property
    def _compared(self) -> set[str]:
        try:
            return {*compared(node for _, node in running(self.sources))}
        except Exception as error:
            net.unjudged(error)
            return set()

    def _ends_like(self, part: Part) -> Iterator[End]:
        """Yield its publishers or subscriptions of a part's type."""
        kind = part.type_name.replace("/", ".")
        for end in self._ends if part.end != "service" else ():
            if end.is_publisher is part.is_publisher and end.type == kind:
                yield end


def choose(candidates: Sequence[Candidate]) -> tuple[Candidate | None, list[Candidate]]:
    """Return the package that looks most like the assignment's, and those that may play its missing parts.

    Of equals, the one higher up in the tree is taken. A further one must be built, must not have the name of
    one that was taken, which makes it a copy, and may play a part that none of those clearly plays.
    """
    if len(candidates) < 2:  # there is nothing to compare
        return next(iter(candidates), None), []
    order = sorted(
        candidates,
        key=lambda candidate: (-candidate.likeness, len(candidate.folder.parts), candidate.folder),
    )
    chosen, *others = order
    played, also = {*chosen.plays}, list[Candidate]()
    for other in others:
        is_copy = other.name in {taken.name for taken in (chosen, *also)}
        if other.is_built and not is_copy and other.may_play - played:
            also.append(other)
            played |= other.plays
    return chosen, also


def why_not(other: Candidate, chosen: Candidate) -> Kind:
    """Return why a package that has nodes is not graded, as a kind of note."""
    if other.is_built < chosen.is_built:
        return "not built"
    if (other.workspace is None) > (chosen.workspace is None) and other.content > chosen.content:
        return "not in src"
    return "more elsewhere" if other.work < chosen.work else "not graded"


def _has_rhythm(part: Part, end: End) -> bool:
    return bool(part.period) and any(has_period(seconds, part.period) for _, seconds in timers_of(end))
