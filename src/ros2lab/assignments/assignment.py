"""An assignment: the package, and the parts that its nodes play."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import cache
from importlib import resources
from itertools import islice
from pathlib import Path
from typing import Any, Literal, cast, get_args

import yaml

from ros2lab.assignments.near_words import near_words
from ros2lab.located_yaml import Reader

SCHEMA = 1
WEEK_2 = "week2"
FILE = "assignment.yaml"

End = Literal["publisher", "subscription", "service"]
Effect = Literal["moving", "still", "any"]
Change = Literal["rhythm", "message"]
Occasion = Literal["", "once", "change"]

_NAME = re.compile(r"[a-z](_?[a-z0-9]+)*")
_TOPIC = re.compile(r"(/[A-Za-z_]\w*)+")
_TYPE = re.compile(r"[a-z]\w*/msg/[A-Z]\w*")
_SERVICE_TYPE = re.compile(r"[a-z]\w*/srv/[A-Z]\w*")
_PARAMETER = re.compile(r"[A-Za-z_][\w.]*")
_OWN_WORD = re.compile(r"[^\W\d_][\w -]*")
MOST_OWN_WORDS = 4
LEAST_BEFORE, MOST_MORE_BEFORE = 3, 3  # words that nobody knows; there are as many commands, or more of them
MOST_COINED = 3  # unknown texts besides the assignment's own
_TEXTS = ("commands", "effects", "unknown", "own", "before", "words")
WITHIN = 2.0  # s, in which a service has to answer, if the assignment does not say it


class AssignmentError(Exception):
    """An assignment that cannot be used; the message names the file, the line, and what to change."""


@dataclass(frozen=True)
class Exchange:
    """A request to a service, and what the response to it has to be; both by field.

    Attributes:
        request: fields that are not named keep their defaults.
        response: only the fields that are named are compared.
    """

    request: Mapping[str, Any] = field(default_factory=dict, hash=False)
    response: Mapping[str, Any] = field(default_factory=dict, hash=False)


@dataclass(frozen=True)
class AskedParameter:
    """A parameter that a node has to have.

    Attributes:
        name: of it.
        value: another one than it has by itself.
        changes: what of the topic is to be another with that value: how often messages come, or what they hold.
    """

    name: str
    value: bool | float | str
    changes: Change


@dataclass(frozen=True)
class Part:
    """What one node has to do.

    Attributes:
        name: of the part, and the executable's in the model solution.
        end: which end of the topic the node has; or that it provides a service.
        topic: its full name; the service's, if it is one.
        type_name: of the topic or the service, such as `std_msgs/msg/String`.
        period: of a publisher, in s; 0 where the assignment leaves it open.
        when: of a publisher, whether it publishes once, or on each change; empty if it is by time, or left open.
        commands: texts that a subscriber has to tell apart and to react to.
        effects: what the numbers of other parts are after each of them: `moving` (not all zero), `still` or `any`.
        unknown: texts that must do no harm.
        own: words of the node's own, which it may react to where it does not know the commands.
        before: words that nobody knows, which are said before the commands where these are said again.
        words: beginnings of words that names of such a node, its topic or its executable are likely to hold.
        requests: requests to a service, in this order, with the responses that are right.
        parameters: that the node of a publisher has to have.
        within: the time in which a service has to answer, in s; 0 if it is none.
    """

    name: str
    end: End
    topic: str
    type_name: str
    period: float = 0.0
    commands: tuple[str, ...] = ()
    effects: tuple[Effect, ...] = ()
    unknown: tuple[str, ...] = ()
    own: tuple[str, ...] = ()
    before: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    requests: tuple[Exchange, ...] = ()
    within: float = 0.0
    parameters: tuple[AskedParameter, ...] = ()
    when: Occasion = ""

    @property
    def is_publisher(self) -> bool:
        """Whether its node publishes."""
        return self.end == "publisher"

    @property
    def short_type(self) -> str:
        """The type as it is written in Python, such as `String`."""
        return self.type_name.rpartition("/")[2]

    def is_meant(self, text: str) -> bool:
        """Return whether a text, such as a name, holds one of its words."""
        return any(word.lower() in text.lower() for word in self.words)


@dataclass(frozen=True)
class Assignment:
    """What is asked for.

    Attributes:
        name: of its folder.
        title: a few words.
        package: the name that the package is to have.
        dependencies: the packages that its package.xml has to declare.
        parts: by name, in the order of the report.
    """

    name: str
    title: str
    package: str
    dependencies: tuple[str, ...]
    parts: Mapping[str, Part]

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics of its parts."""
        return tuple(part.topic for part in self.parts.values())

    @property
    def services(self) -> tuple[Part, ...]:
        """The parts that provide a service."""
        return tuple(part for part in self.parts.values() if part.end == "service")

    @property
    def commanded(self) -> Part | None:
        """The part that takes commands; None if there is none."""
        return next((part for part in self.parts.values() if part.commands), None)

    def meant_by(self, text: str) -> Part | None:
        """Return the part of which a text holds the longest word, such as a name; None if it holds none."""
        found = [
            (len(word), part)
            for part in self.parts.values()
            for word in part.words
            if word.lower() in text.lower()
        ]
        return max(found, key=lambda pair: pair[0])[1] if found else None

    def is_about(self, topic: str, part: Part) -> bool:
        """Return whether a topic holds one of a part's words, is below what all of its own topic is below, or holds the rest.

        What several parts have in common tells none of them, but as a name of a level.
        """
        space, _, own = part.topic.rpartition("/")
        is_below = bool(space) and topic.startswith(f"{space}/")
        return (
            is_below
            or part.is_meant(topic)
            or any(word in topic.lower() for word in re.findall(r"[a-z]+", own))
        )

    def is_only(self, part: Part) -> bool:
        """Return whether no other part has the type of this one, so that the type alone tells what is meant."""
        return all(other is part or other.type_name != part.type_name for other in self.parts.values())

    def with_own_words(self, compared: Iterable[str]) -> Assignment:
        """Return it with the first words with which a hand-in compares something, where these are not the commands."""
        part, texts = self.commanded, [*dict.fromkeys(compared)]
        if part is None or {*part.commands} <= {*texts}:
            return self
        sent = {*part.commands, *part.unknown, part.commands[0].upper()}
        own = [text for text in texts if _OWN_WORD.fullmatch(text) and text not in sent]
        return replace(self, parts={**self.parts, part.name: replace(part, own=tuple(own[:MOST_OWN_WORDS]))})

    def with_coined_words(self, hand_in: str, compared: Iterable[str] = ()) -> Assignment:
        """Return it with words that nobody knows, which differ from hand-in to hand-in: `before`, and more of `unknown`.

        Args:
            hand_in: something of it that is always the same.
            compared: the texts with which it compares something.
        """
        part = self.commanded
        if part is None:
            return self
        digest = hashlib.sha256(hand_in.encode(errors="replace"))
        words = near_words(part.commands, (*part.unknown, *part.own, *compared), digest.hexdigest())
        coined = islice(words, min(len(part.commands), MOST_COINED) if any(part.unknown) else 0)
        asked = self.with_unknown(coined).parts[part.name]
        before = islice(words, LEAST_BEFORE + digest.digest()[0] % MOST_MORE_BEFORE)
        return replace(self, parts={**self.parts, part.name: replace(asked, before=tuple(before))})

    def with_unknown(self, words: Iterable[str]) -> Assignment:
        """Return it with more unknown texts, which come first."""
        part, more = self.commanded, tuple(words)
        if part is None or not more:
            return self
        return replace(self, parts={**self.parts, part.name: replace(part, unknown=(*more, *part.unknown))})

    def plain(self) -> dict[str, Any]:
        """Return it as what JSON can hold; `of_plain` reads it."""
        return asdict(self)

    @classmethod
    def of_plain(cls, data: Mapping[str, Any]) -> Assignment:
        """Read what `plain` returned."""
        parts: dict[str, Part] = {}
        for name, fields in data["parts"].items():
            texts = {key: tuple(fields[key]) for key in _TEXTS}
            requests = tuple(Exchange(**exchange) for exchange in fields["requests"])
            parameters = tuple(AskedParameter(**asked) for asked in fields["parameters"])
            parts[name] = Part(**{**fields, **texts, "requests": requests, "parameters": parameters})
        return cls(**{**data, "dependencies": tuple(data["dependencies"]), "parts": parts})


def load(folder: Path | None = None) -> Assignment:
    """Read an assignment.

    Args:
        folder: that holds `assignment.yaml`; None takes the course's own.

    Raises:
        AssignmentError: if it cannot be read, or does not say what an assignment says.
    """
    if folder is None:
        return _own(WEEK_2)
    path = folder / FILE
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise AssignmentError(
            f"{path} cannot be read ({error}); give a folder with {FILE} and rubric.yaml."
        ) from None
    return _AssignmentReader(str(path), AssignmentError).read(folder.absolute().name, text)


@cache
def _own(name: str) -> Assignment:
    text = resources.files("ros2lab.assignments").joinpath(f"{name}/{FILE}").read_text(encoding="utf-8")
    return _AssignmentReader(FILE, AssignmentError).read(name, text)


class _AssignmentReader(Reader):
    def read(self, name: str, text: str) -> Assignment:
        root = self.root(text)
        if root is None:
            raise AssignmentError(
                f"{self.name}: it is empty; see docs/grading.md for what an assignment holds."
            )
        fields = self.fields(root, "schema", "title", "package", "parts")
        if self.value(fields["schema"]) != SCHEMA:
            raise self.error(fields["schema"], f"the schema must be {SCHEMA}")
        package = self.fields(fields["package"], "name", optional=("dependencies",))
        parts: dict[str, Part] = {}
        for key, node in self.pairs(fields["parts"]):
            part = self._part(self.matching(key, _NAME, "a name such as status_publisher"), node)
            if part.topic in {other.topic for other in parts.values()}:
                what = "service" if part.end == "service" else "topic"
                raise self.error(node, f"another part has the {what} {part.topic}; each needs its own")
            parts[part.name] = part
        if not parts:
            raise self.error(fields["parts"], "an assignment has one part at least")
        return Assignment(
            name=name,
            title=self.text(fields["title"]),
            package=self.matching(package["name"], _NAME, "a package's name such as robot_controller"),
            dependencies=tuple(map(self.text, self.items(package["dependencies"])))
            if "dependencies" in package
            else (),
            parts=parts,
        )

    def _part(self, name: str, node: yaml.Node) -> Part:
        ends: Mapping[str, tuple[End, tuple[str, ...]]] = {
            "publishes": ("publisher", ("period", "parameters", "when")),
            "subscribes": ("subscription", ("commands", "unknown")),
            "provides": ("service", ("requests", "within")),
        }
        given = [key.value for key, _ in self.pairs(node) if key.value in ends]
        if len(given) != 1:
            raise self.error(node, f"{name} needs one of {', '.join(ends)}")
        end, more = ends[given[0]]
        fields = self.fields(node, given[0], "type", optional=(*more, "words"))
        texts = {
            key: tuple(self.any_text(item) for item in self.items(fields[key]))
            for key in ("unknown", "words")
            if key in fields
        }
        commands = dict(self._commands(fields["commands"])) if "commands" in fields else {}
        if end == "service":
            what, pattern, kind = "a service's full name such as /add", _SERVICE_TYPE, "std_srvs/srv/SetBool"
        else:
            what, pattern, kind = "a topic's full name such as /robot/status", _TYPE, "std_msgs/msg/String"
        type_name = self.matching(
            fields["type"], pattern, f"a {'service' if end == 'service' else 'message'}'s type such as {kind}"
        )
        return Part(
            name,
            end,
            self.matching(fields[given[0]], _TOPIC, what),
            type_name,
            period=self.number(fields["period"], 0.01, 10) if "period" in fields else 0.0,
            commands=tuple(commands),
            effects=tuple(commands.values()),
            requests=tuple(self._requests(fields["requests"], fields["type"], type_name))
            if "requests" in fields
            else (),
            within=(self.number(fields["within"], 0.1, 10) if "within" in fields else WITHIN)
            if end == "service"
            else 0.0,
            when=self._occasion(fields) if "when" in fields else "",
            parameters=tuple(self._parameters(fields["parameters"])) if "parameters" in fields else (),
            **{"words": tuple(name.split("_")), **texts},
        )

    def _requests(self, node: yaml.Node, type_node: yaml.Node, type_name: str) -> Iterator[Exchange]:
        """Yield requests and their responses, whose fields are those of the type."""
        from ros2lab.topics import find_type  # noqa: PLC0415 -- assignments are read without ROS, too

        try:
            service = cast(Any, find_type(type_name))
            halves = {"request": service.Request, "response": service.Response}
        except (ValueError, AttributeError):  # it has none if it is itself a half, or no type of a service
            raise self.error(type_node, f"there is no {type_name} on this machine") from None
        for item in self.items(node):
            fields = self.fields(item, optional=("request", "response"))
            yield Exchange(**{key: self._filling(value, halves[key]) for key, value in fields.items()})

    def _filling(self, node: yaml.Node, message_type: type) -> dict[str, Any]:
        """Return values that fit into a message, by field."""
        from portable_ros2.messages import FieldError, fill  # noqa: PLC0415 -- as above

        values = {name.value: self.value(value) for name, value in self.pairs(node)}
        try:
            fill(message_type(), values)
        except FieldError as error:
            raise self.error(node, str(error).rstrip(".")) from None
        return values

    def _occasion(self, fields: Mapping[str, yaml.Node]) -> Occasion:
        text = self.text(fields["when"])
        known = tuple(filter(None, get_args(Occasion)))
        if text not in known:
            raise self.error(fields["when"], f"{' or '.join(known)} is wanted here, not {text!r}")
        if "period" in fields:
            raise self.error(
                fields["when"],
                "what is published on such an occasion has no period; leave out one of the two",
            )
        return cast(Occasion, text)

    def _parameters(self, node: yaml.Node) -> Iterator[AskedParameter]:
        for name, given in self.pairs(node):
            fields = self.fields(given, "value", "changes")
            changes = self.text(fields["changes"])
            if changes not in get_args(Change):
                known = " or ".join(get_args(Change))
                raise self.error(fields["changes"], f"{known} is wanted here, not {changes!r}")
            value = self.value(fields["value"])
            if changes == "rhythm":
                value = self.number(fields["value"], 0)
            elif not isinstance(value, (bool, int, float, str)):
                raise self.error(fields["value"], "a number, a text, true or false is wanted here")
            wanted = "a parameter's name such as period"
            yield AskedParameter(self.matching(name, _PARAMETER, wanted), value, cast(Change, changes))

    def _commands(self, node: yaml.Node) -> Iterator[tuple[str, Effect]]:
        """Yield commands, of a list or with what each of them brings about."""
        if isinstance(node, yaml.SequenceNode):
            yield from ((self.text(item), "any") for item in self.items(node))
            return
        for name, effect in self.pairs(node):
            text = self.text(effect)
            if text not in get_args(Effect):
                raise self.error(effect, f"one of {', '.join(get_args(Effect))} is wanted here, not {text!r}")
            yield self.text(name), cast(Effect, text)
