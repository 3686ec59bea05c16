"""An assignment: the package, and the parts that its nodes play."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, Literal, cast, get_args

import yaml

from ros2lab.located_yaml import Reader

SCHEMA = 1
WEEK_2 = "week2"
FILE = "assignment.yaml"

End = Literal["publisher", "subscription"]
Effect = Literal["moving", "still", "any"]

_NAME = re.compile(r"[a-z](_?[a-z0-9]+)*")
_TOPIC = re.compile(r"(/[A-Za-z_]\w*)+")
_TYPE = re.compile(r"[a-z]\w*/msg/[A-Z]\w*")


class AssignmentError(Exception):
    """An assignment that cannot be used; the message names the file, the line, and what to change."""


@dataclass(frozen=True)
class Part:
    """What one node has to do.

    Attributes:
        name: of the part, and the executable's in the model solution.
        end: which end of the topic the node has.
        topic: its full name.
        type_name: of the topic, such as `std_msgs/msg/String`.
        period: of a publisher, in s; 0 where the assignment leaves it open.
        commands: texts that a subscriber has to tell apart and to react to.
        effects: what the numbers of other parts are after each of them: `moving` (not all zero), `still` or `any`.
        unknown: texts that must do no harm.
        words: beginnings of words that names of such a node, its topic or its executable are likely to hold.
    """

    name: str
    end: End
    topic: str
    type_name: str
    period: float = 0.0
    commands: tuple[str, ...] = ()
    effects: tuple[Effect, ...] = ()
    unknown: tuple[str, ...] = ()
    words: tuple[str, ...] = ()

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

    def is_only(self, part: Part) -> bool:
        """Return whether no other part has the type of this one, so that the type alone tells what is meant."""
        return all(other is part or other.type_name != part.type_name for other in self.parts.values())

    def plain(self) -> dict[str, Any]:
        """Return it as what JSON can hold; `of_plain` reads it."""
        return asdict(self)

    @classmethod
    def of_plain(cls, data: Mapping[str, Any]) -> Assignment:
        """Read what `plain` returned."""
        parts: dict[str, Part] = {}
        for name, fields in data["parts"].items():
            texts = {key: tuple(fields[key]) for key in ("commands", "effects", "unknown", "words")}
            parts[name] = Part(**{**fields, **texts})
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
                raise self.error(node, f"another part has the topic {part.topic}; each needs its own")
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
            "publishes": ("publisher", ("period",)),
            "subscribes": ("subscription", ("commands", "unknown")),
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
        return Part(
            name,
            end,
            self.matching(fields[given[0]], _TOPIC, "a topic's full name such as /robot/status"),
            self.matching(fields["type"], _TYPE, "a message's type such as std_msgs/msg/String"),
            period=self.number(fields["period"], 0.01, 10) if "period" in fields else 0.0,
            commands=tuple(commands),
            effects=tuple(commands.values()),
            **{"words": tuple(name.split("_")), **texts},
        )

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
