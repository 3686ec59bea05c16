"""Two programs that publish on one topic all the time, with different values: who listens there follows neither."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import is_self_attribute
from ros2lab.grading.evidence import Run
from ros2lab.trial.spoken import MOST_SHOWN, Sent, counted, leaves_in, spread
from ros2lab.trial.starts import executable_of

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen

LEAST = 4  # messages of each program
MOST_TIMES = 10  # times as many of one as of the other
_COMMANDS = ("Twist", "TwistStamped", "JointTrajectory", "AckermannDrive", "AckermannDriveStamped", "Wrench", "WrenchStamped", "AttitudeTarget", "ActuatorControl")  # fmt: skip


@dataclass(frozen=True)
class _Rivals:
    """Two programs with what each of them published on a topic."""

    topic: str
    kind: str
    names: tuple[str, str]
    sent: tuple[Sent, Sent]
    places: tuple[str, str]


def rival_faults(seen: Seen) -> Iterator[Finding]:
    """Yield topics on which two programs that are started together command different things."""
    for rivals in _rivals(seen):
        if _are_launched(seen, rivals.names) and _is_command(seen, rivals):
            fix = f"let only one of the two decide: let {rivals.names[0]} return before its publish() while it has nothing to say, or let both publish on topics of their own, and one node choose what goes to {rivals.topic}"
            about = next((place for place in rivals.places if place), "")
            yield Finding(
                "commanded-by-two",
                f"{_told(rivals)}: what listens there gets both in turn.",
                about,
                fix,
                rivals.names,
            )


def told_of_rivals(seen: Seen) -> list[str]:
    """Return what is said of programs that may never run together."""
    return [
        f"{_told(rivals)}; run together, they contradict each other, so it has to be one at a time."
        for rivals in _rivals(seen)
        if rivals.kind in _COMMANDS and not _are_launched(seen, rivals.names)
    ]


def _told(rivals: _Rivals) -> str:
    fields = [leaves_in(sent.values) for sent in rivals.sent]
    names = [name for name in fields[0] | fields[1] if fields[0].get(name) != fields[1].get(name)]
    each = []
    for name, sent, place, found in zip(rivals.names, rivals.sent, rivals.places, fields, strict=True):
        at = f" ({place})" if place else ""
        with_what = ", ".join(spread(one, found[one]) for one in names[:MOST_SHOWN] if one in found)
        each.append(f"{name}{at} {counted(sent.count)} with {with_what or 'less'}")
    return f"Two programs published on {rivals.topic} all the time, with different values: {'; '.join(each)}"


def _rivals(seen: Seen) -> Iterator[_Rivals]:
    """Yield two programs that published on one topic in the same time, and never the same."""
    for together in seen.together:
        said = {name: sent for name, sent in seen.said.together.items() if name not in together.ended}
        runs = {run.programs[0]: run for run in seen.alone}
        for topic, by in together.publishes.items():
            named = [(name, sent[topic]) for name, sent in said.items() if topic in sent and name in runs]
            pairs = [pair for pair in combinations(named, 2) if _contradict(pair[0][1], pair[1][1])]
            kind = next(iter(by.values()))[0].rpartition("/")[2]
            for pair in pairs[:1]:
                # First the one that has nothing to say, if that is so.
                (first, one), (second, other) = sorted(pair, key=lambda named: _says_something(named[1]))
                places = tuple(_place(seen, runs[name], topic) for name in (first, second))
                if len(named) == len((first, second)):
                    yield _Rivals(topic, kind, (first, second), (one, other), (places[0], places[1]))


def _place(seen: Seen, run: Run, topic: str) -> str:
    """Return where a program makes its publisher of a topic."""
    entrance, home = seen.entrance(run.programs[0]), seen.main(run.programs[0])
    ends = seen.ends(topic, is_publisher=True) if entrance else []
    return next((end.place for end in ends if end.creation.source.shown == home), home)


def _contradict(one: Sent, other: Sent) -> bool:
    """Return whether two programs went on at the same time, and never said the same of the same things."""
    if min(one.count, other.count) < LEAST or max(one.count, other.count) > MOST_TIMES * min(
        one.count, other.count
    ):
        return False
    is_apart = _part(one, other) or _part(other, one)
    first, second = leaves_in(one.values), leaves_in(other.values)
    texts = {
        name for name in first | second for leaf in (first.get(name) or second[name]) if isinstance(leaf, str)
    }
    if is_apart or any(first.get(name) != second.get(name) for name in texts):
        return False  # they take turns, or speak of different things
    contents = [{str(value) for value in _bare(sent)} for sent in (one, other)]
    return contents[0].isdisjoint(contents[1])


def _says_something(sent: Sent) -> bool:
    return any(any(leaves) for leaves in leaves_in(sent.values).values())


def _bare(sent: Sent) -> list[dict[str, object]]:
    return [{name: leaves[0] for name, leaves in leaves_in([value]).items()} for value in sent.values]


def _part(one: Sent, other: Sent) -> bool:
    """Return whether one is silent for most of the time in which the other publishes."""
    # Of many messages, only the first and the last ones are known: those between are not missing.
    times, others = (
        sent.times[: len(sent.times) // (1 + (sent.count > len(sent.times)))] for sent in (one, other)
    )
    begin, end = (
        others[0],
        min(others[-1], max(times[-1], others[0])) if one.count > len(one.times) else others[-1],
    )
    third = (end - begin) / 3
    return any(
        not any(begin + third * part <= when <= begin + third * (part + 1) for when in times)
        for part in range(3)
    )


def _are_launched(seen: Seen, names: Sequence[str]) -> bool:
    """Return whether a launch file starts two programs together when it is given no arguments."""
    for file in seen.look.launch_files:
        # The second choice is the one without arguments; the first holds all nodes.
        started = (
            {row[1] for row in file.choices[1]}
            if len(file.choices) > 1
            else {n.executable for n in file.nodes}
        )
        if started.issuperset(map(executable_of, names)):
            return True
    return False


def _is_command(seen: Seen, rivals: _Rivals) -> bool:
    """Return whether a topic tells what to do: by its type, or since its only reader keeps the last value."""
    if rivals.kind in _COMMANDS:
        return True
    readers = seen.ends(rivals.topic, is_publisher=False)
    return len(readers) == 1 and _keeps_last(readers[0])


def _keeps_last(end: object) -> bool:
    """Return whether the callback of a subscription does nothing but keep what it receives in attributes."""
    function = end.sources.function_of(end.creation, end.creation.given("callback"))  # type: ignore[attr-defined]
    body = getattr(function, "body", [])
    return bool(body) and all(
        isinstance(node, ast.Assign) and all(map(is_self_attribute, node.targets)) for node in body
    )
