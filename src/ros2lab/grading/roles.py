"""Which node plays which part of the assignment: by topics and types, never by what things are called alone."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from ros2lab.diagnose.spelling import is_near_miss
from ros2lab.grading.evidence import CommandSeen, Evidence, Executable, Heard, Run

STATUS, COMMAND, VELOCITY = "status_publisher", "command_subscriber", "velocity_publisher"
STRING, TWIST, STAMPED = "std_msgs/msg/String", "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
TOPICS: Mapping[str, str] = {STATUS: "/robot/status", COMMAND: "/robot/command", VELOCITY: "/cmd_vel"}
TYPES: Mapping[str, str] = {STATUS: STRING, COMMAND: STRING, VELOCITY: TWIST}
# What a name is likely to hold, where behaviour leaves it open which node was meant.
HINTS: Mapping[str, re.Pattern[str]] = {
    STATUS: re.compile("stat", re.IGNORECASE),
    COMMAND: re.compile("command|cmd(?!_?vel)|subscri|listen", re.IGNORECASE),
    VELOCITY: re.compile("vel|twist|drive|motion", re.IGNORECASE),
}
# Names of parameters that say how often a timer fires, and in a few languages of those that tell it when.
RATE = re.compile(r"rate|freq|hz|per_second|fps", re.IGNORECASE)
_PERIOD = re.compile(
    r"period|interval|timer|cycle|delay|every|dt\b|tick|time_?step|(publish|update|loop|wait|sleep)\w*_?time|seconds?\b|(^|_)sec(s)?($|_)|takt|abstand|dauer|intervall",
    re.IGNORECASE,
)
MOST_PLAYERS = 10  # nodes that are looked at for one part
PLAIN_SETTINGS = ("alone", "together", "launched")  # all others are those of a changed parameter

Match = Literal["right", "near", "other"]
_MATCHES: tuple[Match, ...] = ("right", "near", "other")


def is_timers(name: str) -> bool:
    """Return whether a parameter of this name seems to be a timer's."""
    return bool(RATE.search(name) or _PERIOD.search(name))


def is_near(topic: str, wanted: str) -> bool:
    """Return whether a topic is likely to be meant for another one."""
    return is_near_miss(topic, wanted) or topic.endswith(wanted) or topic == f"/{wanted.rpartition('/')[2]}"


@dataclass(frozen=True)
class Part:
    """A node that plays a part, as it was seen in one run.

    Attributes:
        role: the part.
        match: how its topic fits: the right one, one nearly so named, or another one.
        topic: that it publishes, or to which it subscribes.
        node: its full name.
        types: of the topic.
        number: of the run.
        run: in which it was seen.
        program: that has the node; empty if that is not known.
    """

    role: str
    match: Match
    topic: str
    node: str
    types: tuple[str, ...]
    number: int
    run: Run
    program: str

    @property
    def heard(self) -> list[Heard]:
        """What was published on its topic, before and after each command."""
        parts = [self.run.quiet, *(command.topics for command in self.run.commands)]
        return [part[self.topic] for part in parts if self.topic in part]

    @property
    def is_heard(self) -> bool:
        """Whether anything came of it."""
        if self.role == COMMAND:
            return any(one.log or one.topics or one.parameters for one in self.run.commands)
        return any(heard.count for heard in self.heard)

    @property
    def key(self) -> str:
        """Where the evidence has it."""
        ends = "subscribes" if self.role == COMMAND else "publishes"
        return f"runs[{self.number}].{ends}.{self.topic}"

    @property
    def quiet_key(self) -> str:
        """Where the evidence has what it published before any command."""
        return f"runs[{self.number}].quiet.{self.topic}"

    @property
    def end(self) -> str | None:
        """What its program said last, if it ended by itself; None if it did not."""
        return self.run.ended.get(self.program)

    @property
    def last_command(self) -> CommandSeen | None:
        """The command after which not all programs ran any more; None if there is none."""
        return next((one for one in self.run.commands if not one.is_alive), None)


class Case:
    """The evidence, and who plays which part in it."""

    def __init__(self, evidence: Evidence) -> None:
        self.evidence = evidence

    @cached_property
    def executables(self) -> dict[str, Executable]:
        """The programs by name."""
        return {one.name: one for one in self.evidence.build.executables} if self.evidence.build else {}

    @property
    def package(self) -> str:
        """The name of the assignment's package; empty if there is none."""
        package = self.evidence.submission.get("package") or {}
        return str(package.get("name") or "")

    @cached_property
    def short_lived(self) -> frozenset[str]:
        """The full names of the nodes whose program ended by itself while it was alone."""
        alone = (run for run in self.evidence.runs if run.setting == "alone" and run.ended)
        return frozenset(node for run in alone for node in run.nodes)

    @cached_property
    def parts(self) -> dict[str, list[Part]]:
        """By role, who plays it; in each run in which it was seen, the most telling first."""
        found: dict[str, list[Part]] = {role: [] for role in TOPICS}
        runs = [
            (number, run) for number, run in enumerate(self.evidence.runs) if run.setting in PLAIN_SETTINGS
        ]
        owners = {node: run.programs[0] for _, run in runs if run.setting == "alone" for node in run.nodes}
        for number, run in runs:
            for part in _parts(number, run, owners):
                found[part.role].append(part)
        for role, parts in found.items():
            taken = {
                (part.number, part.topic)
                for other in found.values()
                for part in other
                if part.role != role and part.match != "other"
            }
            kept = [part for part in parts if part.match != "other" or (part.number, part.topic) not in taken]
            found[role] = sorted(kept, key=self._rank)
        # Other nodes may take the commands, too; the one that does nothing else is meant.
        busy = {
            (part.number, part.node)
            for role in (STATUS, VELOCITY)
            for part in found[role]
            if part.match == "right"
        }
        found[COMMAND].sort(key=lambda part: (*self._rank(part)[:3], (part.number, part.node) in busy))
        return found

    def main(self, role: str) -> Part | None:
        """Return the most telling of `parts`."""
        return next(iter(self.parts[role]), None)

    def at_once(self, role: str) -> Part | None:
        """Return the most telling of `parts` in that way of starting in which most of the topics are right.

        The programs themselves are one way, each launch file is another: nobody puts two together.
        """
        numbered = [*enumerate(self.evidence.runs)]
        ways = [{number} for number, run in numbered if run.setting == "launched"]
        ways.append({number for number, run in numbered if run.setting != "launched"})
        rights = [
            sum(
                any(one.match == "right" and one.number in way for one in parts)
                for parts in self.parts.values()
            )
            for way in ways
        ]
        best = set().union(*(way for way, count in zip(ways, rights, strict=True) if count == max(rights)))
        return next((one for one in self.parts[role] if one.number in best), self.main(role))

    def whole(self, role: str) -> Part | None:
        """Return the part in the run with all commands, where it works in one; else the most telling."""
        parts = self.parts[role]
        main = self.main(role)
        return next((one for one in parts if one.run.setting == "alone" and one.is_heard), main)

    @cached_property
    def doubled(self) -> frozenset[str]:
        """The roles for which there is no node of their own, but one that plays an earlier role, too."""
        roles = [role for role in TOPICS if self.parts[role]]
        best = max(itertools.product(*map(self._players, roles)), key=lambda players: len({*players}))
        return frozenset(role for number, role in enumerate(roles) if best[number] in best[:number])

    def _players(self, role: str) -> list[tuple[str, str, str]]:
        """Return the nodes that play a part as well as any, by program and name; those of one name are told apart."""
        parts = [part for part in self.parts[role] if part.match == self.parts[role][0].match]
        parts = [part for part in parts if part.run.setting == "alone"] or parts
        nodes = ((one.program, one.node, role if one.node in one.run.twins else "") for one in parts)
        return [*dict.fromkeys(nodes)][:MOST_PLAYERS]

    def is_installed(self, part: Part) -> bool:
        """Return whether `ros2 run` or `ros2 launch` starts it."""
        if part.run.setting == "launched":
            return True
        program = self.executables.get(part.program)
        return program is not None and program.way == "installed" and not program.fault

    def _rank(self, part: Part) -> tuple[object, ...]:
        return (
            _MATCHES.index(part.match),
            TYPES[part.role] not in part.types,
            not part.is_heard,
            not self.is_installed(part),
            PLAIN_SETTINGS.index(part.run.setting),
            part.number,
            part.topic,
            part.node,
        )


def _parts(number: int, run: Run, owners: Mapping[str, str]) -> Iterator[Part]:
    for ends, roles in ((run.publishes, (STATUS, VELOCITY)), (run.subscribes, (COMMAND,))):
        for topic, nodes in ends.items():
            for node, types in nodes.items():
                program = run.programs[0] if len(run.programs) == 1 else owners.get(node, "")
                for role in roles:
                    match = _match(role, topic, types, run, node=node, program=program)
                    if match:
                        yield Part(role, match, topic, node, tuple(types), number, run, program)


def _match(role: str, topic: str, types: list[str], run: Run, *, node: str, program: str) -> Match | None:
    wanted = TOPICS[role]
    if topic in TOPICS.values():  # one of the other two is no misspelt one
        return "right" if topic == wanted else None
    if is_near(topic, wanted):
        return "near"
    if role == VELOCITY:
        is_other = TWIST in types or STAMPED in types
    elif STRING not in types or not HINTS[role].search(f"{topic} {node} {program}"):
        is_other = False
    elif role == STATUS:
        # What the other two nodes say of themselves is not the robot's status.
        is_busy = node in run.subscribes.get(TOPICS[COMMAND], ()) or node in run.publishes.get(
            TOPICS[VELOCITY], ()
        )
        is_other = not is_busy and topic in run.quiet and run.quiet[topic].count > 1
    else:
        is_other = topic not in run.publishes
    return "other" if is_other else None
