"""A node that plays a part of the assignment, as seen in one run."""

from __future__ import annotations

import builtins
import itertools
import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Literal

from ros2lab.assignments import Assignment, Part
from ros2lab.grading.evidence import (
    DOCUMENTED,
    GIVEN,
    KEYBOARD,
    CommandSeen,
    Executable,
    Files,
    Heard,
    Run,
    ServiceCall,
)
from ros2lab.grading.reading.stand_in import NotInstalledHere
from ros2lab.grading.sandbox.worlds import FILES

# Names of parameters for a timer's rate and period; those with other names are found by what they change.
RATE = re.compile(r"rate|freq|hz|per_second|fps", re.IGNORECASE)
_PERIOD = re.compile(
    r"period|interval|timer|cycle|delay|every|dt\b|tick|time_?step|(publish|update|loop|wait|sleep)\w*_?time|seconds?\b|(^|_)sec(s)?($|_)",
    re.IGNORECASE,
)
_NOTHING_HERE = NotInstalledHere.__name__
_ERROR = r"^[\w.]*(?:Error|Exception|gaierror)\b.*"
# The error that ends a program on a machine without this resource.
_LACKED = {
    "a device": re.compile(rf"{_ERROR}(?<![\w.-])/(?:dev|sys)/"),
    "a network": re.compile(
        rf"{_ERROR}(?:Connection refused|Network is unreachable|No route to host|in name resolution|service not known)"
    ),
    "a display": re.compile(
        rf"{_ERROR}no display name|(?i:cannot|could not|unable to) (?i:connect to|open) (?i:X server|display)\b"
    ),
}
_WANTS = {
    _NOTHING_HERE: re.compile(_NOTHING_HERE),
    # Other readers, such as pickle, say more after EOFError.
    KEYBOARD: re.compile(
        r"^EOFError(?:: EOF when reading a line)?\s*$|\btermios\.error\b|Inappropriate ioctl for device|\bcurses\.error\b"
    ),
    **_LACKED,
}
_HEADER = "Traceback (most recent call last)"
_FRAME = re.compile(r'\s*File "([^"]*)", line \d')
_RAISES = re.compile(r"\braise\b")
_TEXT = re.compile(r"\"[^\"]*\"|'[^']*'")
_KIND = re.compile(rf"([\w.]+)(?:: (?P<only>{_NOTHING_HERE})?|$)")
PLAIN_SETTINGS = ("alone", "together", "launched", DOCUMENTED, GIVEN)  # all others name a changed parameter
STAND_IN = "std_msgs/msg/Empty"  # the base class of the stand-in for a message that is not installed here

Match = Literal["right", "near", "other", "unnamed", "misplaced"]
MATCHES: tuple[Match, ...] = ("right", "near", "other", "unnamed", "misplaced")


def is_timers(name: str) -> bool:
    """Return whether a parameter's name suggests that it sets a timer."""
    return bool(RATE.search(name) or _PERIOD.search(name))


def is_for_want(said: str, program: Executable | None = None, files: Files | None = None) -> bool:
    """Return whether a program's last output is an error caused only by what the grading machine lacks; see `wants`."""
    return bool(wants(said, program, files))


def finds_no_keyboard(said: str) -> bool:
    """Return whether a program's last output holds the error of reading a keyboard that is not there."""
    return KEYBOARD in wants(said)


def lacked(said: str, program: Executable | None = None, files: Files | None = None) -> list[str]:
    """Return which resources the grading machine lacks; see `wants`."""
    return [want for want in wants(said, program, files) if want in _LACKED]


def wants(said: str, program: Executable | None = None, files: Files | None = None) -> list[str]:
    """Return what the grading machine lacks, by the errors in a program's last output and by their causes.

    An error that the submission itself raises says nothing about the machine, nor does what a program prints that
    catches no error; one that is not given may catch any.
    """
    told = {
        (want, bool(file)) for line, file, source in _errors(said) for want in _wants_of(line, file, source)
    }
    is_believed = not any((want, False) in told for want in _LACKED) or _catches(program, files)
    sure = {want for want, has_frames in told if has_frames or is_believed or want not in _LACKED}
    return [want for want in _WANTS if want in sure]


def _catches(program: Executable | None, files: Files | None) -> bool:
    """Return whether a program catches any error, as far as is known."""
    if program is None or files is None or not program.modules:
        return True
    places = (*files.handlers.get("by name", ()), *files.handlers.get("wholesale", ()))
    return any(PurePosixPath(place.file).stem in (*program.modules, program.stem) for place in places)


def _wants_of(line: str, file: str, source: str) -> Iterator[str]:
    """Yield what is lacked by the last line of an error that a line of code in a file has raised."""
    is_own, kind = file.startswith(f"{FILES}/") and _RAISES.search(source), _KIND.match(line)
    python = getattr(builtins, kind[1], None) if kind else None
    is_of_value = isinstance(python, type) and not issubclass(python, (OSError, RuntimeError))
    for want in (want for want, error in _WANTS.items() if error.search(line)):
        # An error of a stand-in may be raised: it says nothing but its name.
        is_its_word = want == _NOTHING_HERE and kind and kind["only"] and python is None
        if is_its_word or not (is_own or (is_of_value and want in _LACKED)):
            yield want


def _errors(said: str) -> Iterator[tuple[str, str, str]]:
    """Yield each line that may be an error, with the file and the code of the frame that raised it; empty without a traceback."""
    file, source = "", ""
    for line in said.splitlines():
        if line.startswith(_HEADER):
            file, source = _HEADER, ""
        elif place := _FRAME.match(line):
            file, source = place[1], ""
        elif file and not source and line.startswith("    "):
            source = _TEXT.sub("", line)
        else:
            yield line, file, source


def stamped(type_name: str) -> str:
    """Return the type that adds a header to another type, such as TwistStamped for Twist."""
    return f"{type_name}Stamped"


def is_done(part: Part, run: Run, types: Collection[str] = ()) -> bool:
    """Return whether a part worked in a run, on whatever topic: something came of it, or no command was sent.

    Args:
        part: the part.
        run: the run.
        types: types that count besides those that the part must have.
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


def is_busy(assignment: Assignment, part: Part, node: str, run: Run, besides: str = "") -> bool:
    """Return whether a node has the topic of another part in a run, besides one of its topics."""
    others = (other for other in assignment.parts.values() if other is not part and other.topic != besides)
    return any(
        node in (run.publishes if other.is_publisher else run.subscribes).get(other.topic, ())
        for other in others
    )


def deadly_in(run: Run) -> CommandSeen | None:
    """Return the command after which a program of the run had ended; None if there is none."""
    return next((command for command in run.commands if not command.is_alive), None)


@dataclass(frozen=True)
class Player:
    """A node that plays a part, as seen in one run.

    Attributes:
        part: the part of the assignment.
        match: how its topic fits: the right one, a similar name, another one, one that only its type tells,
            or one of another part.
        topic: the topic or service of its end.
        node: its full name; its program's name if it was only read in the code.
        types: the types of the topic.
        number: the run's number.
        run: the run in which it was seen.
        program: the program that has the node; empty if that is not known.
        is_read: whether it was only read in the code, because its program ended before it could be seen.
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
        """What was published on its topic before any request or command, and after each."""
        return [heard for _, heard in self.heard_at]

    @property
    def heard_at(self) -> list[tuple[str, Heard]]:
        """The same, each with its key in the evidence; nothing that follows commands where it only repeats these."""
        run, place = self.run, f"runs[{self.number}]"
        said = [] if self.repeats_words else run.commands
        stretches = [
            (f"{place}.quiet", run.quiet),
            (f"{place}.meanwhile", run.meanwhile),
            *((f"{place}.calls[{n}].topics", call.topics) for n, call in enumerate(run.calls)),
            *((f"{place}.commands[{n}].topics", command.topics) for n, command in enumerate(said)),
        ]
        return [
            (f"{key}.{self.topic}", topics[self.topic])
            for key, topics in stretches
            if self.topic in topics and topics[self.topic].type_name in self.types
        ]

    @property
    def only_answers(self) -> bool:
        """Whether all that came from it came while something was given to it."""
        return [key for key, _ in self.heard_at] == [f"runs[{self.number}].meanwhile.{self.topic}"]

    @property
    def repeats_words(self) -> bool:
        """Whether its node says the words that it takes, and nothing else."""
        run, topic = self.run, self.topic
        said = [
            (value.get("data"), command.text)
            for command in run.commands
            for value in (command.topics[topic].values if topic in command.topics else ())
        ]
        is_taker = self.node in run.subscribes.get(run.commanded, ()) and topic not in run.quiet
        return is_taker and bool(said) and all(data == text for data, text in said)

    @property
    def calls(self) -> list[ServiceCall]:
        """The calls to its service."""
        return [call for call in self.run.calls if call.service == self.topic]

    @property
    def commands(self) -> list[CommandSeen]:
        """The commands that were published on its topic."""
        return self.run.commands if self.run.commanded == self.topic else []

    @property
    def is_heard(self) -> bool:
        """Whether it published, answered or reacted at all."""
        if self.part.end == "service":
            return any(call.response is not None for call in self.calls)
        if not self.part.is_publisher:
            return any(command.log or command.topics or command.parameters for command in self.commands)
        return any(heard.count for heard in self.heard)

    @property
    def comes_by_itself(self) -> bool:
        """Whether several messages came on its topic before any command or request."""
        return self.topic in self.run.quiet and self.run.quiet[self.topic].count > 1

    @property
    def is_idle(self) -> bool:
        """Whether it is a publisher on a topic other than the right one, and published nothing there."""
        return self.part.is_publisher and self.match != "right" and not self.is_heard

    @property
    def key(self) -> str:
        """Its key in the evidence."""
        if self.is_read:
            return "files.ends"
        ends = {"publisher": "publishes", "subscription": "subscribes", "service": "services"}
        return f"runs[{self.number}].{ends[self.part.end]}.{self.topic}"

    @property
    def quiet_key(self) -> str:
        """The key in the evidence of what it published before any command."""
        return f"runs[{self.number}].quiet.{self.topic}"

    @property
    def end(self) -> str | None:
        """The last output of its program, if that ended by itself; None if it did not."""
        return self.run.ended.get(self.program)

    @property
    def is_done(self) -> bool:
        """Whether its program ended by itself, and said by its exit code that all went well."""
        return self.program in self.run.done

    @property
    def last_command(self) -> CommandSeen | None:
        """The command after which a program of its run had ended; None if there is none."""
        return deadly_in(self.run)

    @property
    def is_ended_by_command(self) -> bool:
        """Whether a command was the end of its program, and of no other one in its run."""
        return self.last_command is not None and [*self.run.ended] == [self.program]

    @property
    def restarted_at(self) -> CommandSeen | None:
        """The command at which its node was there anew, if no known one may be the reason, at which it may restart."""
        for earlier, later in itertools.pairwise(self.commands):
            if self.node in later.anew and {earlier.text, later.text}.isdisjoint(self.part.commands):
                return later
        return None

    @property
    def taken_ends(self) -> tuple[bool, ...]:
        """The ends of its topic (True for publishers) where a player of another part rules this one out."""
        ends = {"unnamed": (self.part.is_publisher,), "misplaced": ()}
        return ends.get(self.match, (True, False))

    @property
    def is_guessed(self) -> bool:
        """Whether no topic tells that it plays its part."""
        return self.match in ("unnamed", "misplaced")


def on_one_topic(players: Iterable[Player]) -> Iterator[Player]:
    """Yield for each node of each run its player on the first topic; others only if that one is silent."""
    best: dict[tuple[int, str], Player] = {}
    for player in players:
        first = best.setdefault((player.number, player.node), player)
        if player.topic == first.topic or (player.is_heard and not first.is_heard):
            yield player


def without_given(players: list[Player]) -> list[Player]:
    """Return the players without those of runs in which something was given, if one as right works without that.

    Those that take something count only where none reacted alone, and no program ended by what it was given.
    """
    usual = [player for player in players if player.run.setting != GIVEN]
    alone = (
        player
        for player in usual
        if player.is_heard and (player.part.is_publisher or player.run.setting == "alone")
    )
    best = min((MATCHES.index(player.match) for player in alone), default=len(MATCHES))
    fit = [one for one in players if one.is_heard and (one.part.is_publisher or not one.run.ended)]
    fit = [one for one in fit if MATCHES.index(one.match) < best]
    return [player for player in players if player.run.setting != GIVEN or player in fit]


def of_one_node(players: Iterable[Player], best: Player | None) -> list[Player]:
    """Return the players of a publisher's part that are on the topic of its best one, or of the same node.

    What another node does on another topic answers no question about this one.
    """
    return [
        player
        for player in players
        if best is None
        or not best.part.is_publisher
        or player.topic == best.topic
        or player.node.rpartition("/")[2] == best.node.rpartition("/")[2]
    ]
