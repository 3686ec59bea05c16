"""The notes on a submission while it is received: their kinds, and the paths that they are about."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

Kind = Literal[
    "outside",
    "from elsewhere",
    "of another workspace",
    "no target",
    "no file",
    "by a tool",
    "by a build",
    "made",
    "path too long",
    "name taken",
    "not unicode",
    "too large",
    "unreadable",
    "unpacked",
    "not unpacked",
    "too deep",
    "ignored by colcon",
    "in another package",
    "one of too many packages",
    "too much python",
    "too large python",
    "not graded",
    "more elsewhere",
    "not built",
    "not in src",
    "for a library",
    "refused",
]
SENTENCES: Mapping[Kind, str] = {
    "outside": "Refused, because it leads out of the submission",
    "from elsewhere": "Taken from elsewhere in the repository",
    "of another workspace": "Left out, because it links to another workspace of the repository",
    "no target": "Left out, because it links to nothing that was handed in",
    "no file": "Refused, because it is neither a file nor a folder nor a link",
    "by a tool": "Left out, because a tool made it",
    "by a build": "Left out, because a build made it",
    "made": "Kept, though Python or a build made it",
    "path too long": "Left out, because its path is too long or too deep",
    "name taken": "Left out, because something else has the same name",
    "not unicode": "Kept, though its name is not valid Unicode",
    "too large": "Left out, because it is larger than {detail}",
    "unreadable": "Left out, because it cannot be read",
    "unpacked": "Unpacked, because there was no package outside it",
    "not unpacked": "Not unpacked",
    "too deep": "Not unpacked, because it lies in more than {detail} archives",
    "ignored by colcon": "colcon does not look into this folder, because a COLCON_IGNORE or an AMENT_IGNORE lies in it",
    "in another package": "colcon does not see this package, because it lies in another one",
    "one of too many packages": "Not looked at, because there are more than {detail} packages",
    "too much python": "Not looked at, because there is more than {detail} bytes of Python",
    "too large python": "Not looked at, because it is larger than {detail} bytes",
    "not graded": "Not graded, for the package in {detail} fits what was asked for at least as well",
    "more elsewhere": "Not graded, for the package in {detail} has more of what was asked for",
    "not built": "Not graded, for colcon builds no executable of it, as it does of the package in {detail}",
    "not in src": "Not graded, for it does not lie in the src of a workspace, as the package in {detail} does",
    "for a library": "What imports it runs with it, and not with the library of its name that is installed",
    "refused": "{detail}",
}
MOST_NAMED = 5  # paths, in a sentence
MOST_KEPT = 1000  # paths, of a kind


@dataclass(frozen=True)
class Note:
    """What was done with some members of a submission, or noticed about them.

    Attributes:
        kind: what was done, and why.
        paths: the members' paths, in a form that can be shown; there may be fewer than `count`.
        detail: what the kind leaves open, such as a limit.
        count: how many members it is about.
    """

    kind: Kind
    paths: list[str] = field(default_factory=list)
    detail: str = ""
    count: int = 0

    def __str__(self) -> str:
        reason = SENTENCES[self.kind].format(detail=self.detail)
        return f"{reason}: {first_of(self.paths, self.count)}." if self.paths else reason


def spoken(path: str) -> str:
    """Return a path in a submission as it is written in a sentence."""
    return "the top folder" if path == "." else path


def first_of(names: Sequence[str], count: int = 0) -> str:
    """Return the first of some names as a list, and how many more there are; there may be more than names."""
    more = max(count, len(names)) - MOST_NAMED
    return ", ".join(map(spoken, names[:MOST_NAMED])) + (f" and {more} more" if more > 0 else "")
