"""A node that plays a part of the assignment, as it was seen in one run."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from ros2lab.assignments import Part
from ros2lab.grading.evidence import (
    GIVEN,
    CommandSeen,
    Heard,
    Run,
    ServiceCall,
)
from ros2lab.grading.sandbox import FILES
from ros2lab.grading.stand_in import NotInstalledHere

# Names of parameters that say how often a timer fires, and when; by other names they are found by what they change.
RATE = re.compile(r"rate|freq|hz|per_second|fps", re.IGNORECASE)
_PERIOD = re.compile(
    r"period|interval|timer|cycle|delay|every|dt\b|tick|time_?step|(publish|update|loop|wait|sleep)\w*_?time|seconds?\b|(^|_)sec(s)?($|_)",
    re.IGNORECASE,
)
# What a program says last that finds nobody at the keyboard; other readers, such as pickle, say what has ended.
_NO_KEYBOARD = re.compile(
    r"^EOFError(?:: EOF when reading a line)?\s*$|\btermios\.error\b|Inappropriate ioctl for device|\bcurses\.error\b"
)
_FRAME = re.compile(r'\s*File "([^"]*)", line \d')
_RAISES = re.compile(r"\braise\b")
_TEXT = re.compile(r"\"[^\"]*\"|'[^']*'")
_ERROR = r"^[\w.]*(?:Error|Exception|gaierror)\b.*"
# What ends a program, by itself or through a library, where a machine has no such thing.
_LACKED = {
    "a device": re.compile(rf"{_ERROR}(?<![\w.-])/(?:dev|sys)/", re.MULTILINE),
    "a network": re.compile(
        rf"{_ERROR}(?:Connection refused|Network is unreachable|No route to host|in name resolution|service not known)",
        re.MULTILINE,
    ),
    "a display": re.compile(
        rf"{_ERROR}no display name|(?:cannot|could not|unable to) (?:connect to|open) (?:X server|display)\b",
        re.MULTILINE | re.IGNORECASE,
    ),
}
PLAIN_SETTINGS = ("alone", "together", "launched", GIVEN)  # all others are those of a changed parameter
STAND_IN = "std_msgs/msg/Empty"  # which a message that is not installed here is derived from

Match = Literal["right", "near", "other", "unnamed"]
MATCHES: tuple[Match, ...] = ("right", "near", "other", "unnamed")


def is_timers(name: str) -> bool:
    """Return whether a parameter of this name seems to be a timer's."""
    return bool(RATE.search(name) or _PERIOD.search(name))


def is_for_want(said: str) -> bool:
    """Return whether what a program said last is an error that only what is not there where it is graded has caused."""
    return NotInstalledHere.__name__ in said or finds_no_keyboard(said) or bool(lacked(said))


def finds_no_keyboard(said: str) -> bool:
    """Return whether a program's last words hold an error that reading a keyboard brings where nobody sits at it.

    One that the submission itself raises is none, whatever its name.
    """
    file, source = "", ""  # of the frame in which an error was raised
    lines = said.splitlines()
    for line, following in zip(lines, [*lines[1:], ""], strict=False):
        if place := _FRAME.match(line):
            file, source = place[1], _TEXT.sub("", following)
        elif _NO_KEYBOARD.search(line) and not (file.startswith(f"{FILES}/") and _RAISES.search(source)):
            return True
    return False


def lacked(said: str) -> list[str]:
    """Return what the machine on which it is graded lacks, as the error tells with which a program ended."""
    return [resource for resource, error in _LACKED.items() if error.search(said)]


def stamped(type_name: str) -> str:
    """Return the type that holds another one and a header, such as TwistStamped of Twist."""
    return f"{type_name}Stamped"


def is_done(part: Part, run: Run, types: Collection[str] = ()) -> bool:
    """Return whether a part was done in a run, on whatever topic: something came of it, or nothing was asked for.

    Args:
        part: of the assignment.
        run: in which it may have been done.
        types: that it may have besides those that it is to have.
    """
    types = {part.type_name, stamped(part.type_name), *types}
    if part.end == "service":
        return any(types & {*kinds} for nodes in run.services.values() for kinds in nodes.values())
    if part.end == "publisher":
        return any(
            heard.type_name in types and heard.count for topics in run.stretches for heard in topics.values()
        )
    is_there = any(types & {*kinds} for nodes in run.subscribes.values() for kinds in nodes.values())
    is_answered = any(command.log or command.topics or command.parameters for command in run.commands)
    return is_there and (is_answered or not run.commands)


def deadly_in(run: Run) -> CommandSeen | None:
    """Return the command after which not all programs of a run ran any more; None if there is none."""
    return next((command for command in run.commands if not command.is_alive), None)


@dataclass(frozen=True)
class Player:
    """A node that plays a part, as it was seen in one run.

    Attributes:
        part: of the assignment.
        match: how its topic fits: the right one, one nearly so named, another one, or one of which nothing but the
            type tells.
        topic: that it publishes, or to which it subscribes.
        node: its full name; its program's where it was only read.
        types: of the topic.
        number: of the run.
        run: in which it was seen.
        program: that has the node; empty if that is not known.
        is_read: whether it stands in the code only, for its program has ended for want of what is not installed here.
    """

    part: Part
    match: Match
    topic: str
    node: str
    types: tuple[str, ...]
    number: int
    run: Run
    program: str
    is_read: bool = False

    @property
    def heard(self) -> list[Heard]:
        """What was published on its topic: before any request or command, and after each."""
        return [heard for _, heard in self.heard_at]

    @property
    def heard_at(self) -> list[tuple[str, Heard]]:
        """The same, with where the evidence has it."""
        run, place = self.run, f"runs[{self.number}]"
        stretches = [
            (f"{place}.quiet", run.quiet),
            *((f"{place}.calls[{n}].topics", call.topics) for n, call in enumerate(run.calls)),
            *((f"{place}.commands[{n}].topics", command.topics) for n, command in enumerate(run.commands)),
        ]
        return [
            (f"{key}.{self.topic}", topics[self.topic]) for key, topics in stretches if self.topic in topics
        ]

    @property
    def calls(self) -> list[ServiceCall]:
        """The calls of its service."""
        return [call for call in self.run.calls if call.service == self.topic]

    @property
    def commands(self) -> list[CommandSeen]:
        """The commands that were published on its topic."""
        return self.run.commands if self.run.commanded == self.topic else []

    @property
    def is_heard(self) -> bool:
        """Whether anything came of it."""
        if self.part.end == "service":
            return any(call.response is not None for call in self.calls)
        if not self.part.is_publisher:
            return any(command.log or command.topics or command.parameters for command in self.commands)
        return any(heard.count for heard in self.heard)

    @property
    def is_idle(self) -> bool:
        """Whether nothing comes on a topic that is not the right one: another one, on which it does, tells more."""
        return self.part.is_publisher and self.match != "right" and not self.is_heard

    @property
    def key(self) -> str:
        """Where the evidence has it."""
        if self.is_read:
            return "files.ends"
        ends = {"publisher": "publishes", "subscription": "subscribes", "service": "services"}
        return f"runs[{self.number}].{ends[self.part.end]}.{self.topic}"

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
        return deadly_in(self.run)

    @property
    def taken_ends(self) -> tuple[bool, ...]:
        """The ends of its topic, the publishers' and the others', at which another player keeps it from its part."""
        return (self.part.is_publisher,) if self.match == "unnamed" else (True, False)


def on_one_topic(players: Iterable[Player]) -> Iterator[Player]:
    """Yield of each node in each run the player on the first topic, and others only where nothing comes of that."""
    best: dict[tuple[int, str], Player] = {}
    for player in players:
        first = best.setdefault((player.number, player.node), player)
        if player.topic == first.topic or (player.is_heard and not first.is_heard):
            yield player


def without_given(players: list[Player]) -> list[Player]:
    """Return players less those of whom something came only because it was given, where something comes by itself.

    Nor is what was given a reaction.
    """
    is_heard = any(player.is_heard for player in players if player.run.setting != GIVEN)
    return [
        player
        for player in players
        if player.run.setting != GIVEN or (player.part.is_publisher and player.is_heard and not is_heard)
    ]
