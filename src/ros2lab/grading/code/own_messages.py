"""The messages and services that a submission defines itself, read from its .msg and .srv files."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import read_text

_NAMED = {"float64": "double", "float32": "float", "bool": "boolean"}  # as the made class has them
_FIELD = re.compile(
    r"(?P<kind>[\w/]+)(?P<many>\[.*?\])?(?:<=\d+)?\s+(?P<name>[A-Za-z]\w*)\s*(?P<constant>=)?"
)
_PARTS = {"msg": ("",), "srv": ("_Request", "_Response")}

Fields = Mapping[str, str]


@dataclass(frozen=True)
class Messages:
    """What is known of messages: of those that are installed, and of a submission's own.

    Attributes:
        own: the fields of its own, by the name of the class.
        stems: by package of its own, the names of all its files without what comes after the first dot.
    """

    own: Mapping[str, Fields] = field(default_factory=dict)
    stems: Mapping[str, frozenset[str]] = field(default_factory=dict)

    def fields_of(self, kind: str | None) -> Fields | None:
        """Return the fields of a message such as `geometry_msgs.msg.Twist`, name to type; None if not known."""
        return self.own.get(kind or "") or interfaces.fields_of(kind)

    def lacks(self, name: str) -> bool:
        """Return whether a message would have to come from a package of the submission that defines none of that name."""
        package, _, rest = name.partition(".")
        kind, _, short = rest.partition(".")
        stems = self.stems.get(package)
        return kind in (*_PARTS, "action") and stems is not None and not {short, kind, "__init__"} & stems


def own_messages(packages: Iterable[tuple[str, Path]]) -> Messages:
    """Return what the packages of a submission define, by their names and folders.

    A package with Python code that may be such a module by itself is left out of what can lack a message.
    """
    own, stems = dict[str, Fields](), dict[str, frozenset[str]]()
    for name, folder in packages:
        files = [path for path in folder.rglob("*") if path.is_file()]
        stems[name] = frozenset(path.name.partition(".")[0] for path in files)
        for path in files:
            suffixes = _PARTS.get(path.suffix.lstrip("."), ())
            parts = re.split(r"(?m)^---\s*$", read_text(path)) if suffixes else ()
            for suffix, text in zip(suffixes, parts, strict=False):
                made = f"{name}.{path.suffix.lstrip('.')}.{PurePosixPath(path.name).stem}{suffix}"
                own[made] = _fields(text, name)
    return Messages(own, stems)


def _fields(text: str, package: str) -> Fields:
    found = dict[str, str]()
    for line in text.splitlines():
        if match := _FIELD.match(line.partition("#")[0].strip()):
            kind = _NAMED.get(match["kind"], match["kind"])
            if kind[:1].isupper():
                kind = f"std_msgs/{kind}" if kind == "Header" else f"{package}/{kind}"
            is_plain = not (match["many"] or match["constant"])
            found[match["name"]] = kind if is_plain else ""
    return found
