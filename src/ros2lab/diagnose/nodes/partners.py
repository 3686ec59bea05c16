"""Whether an end of a topic or a service may have a partner, and which packages are used together."""

from __future__ import annotations

from collections.abc import Collection
from typing import Protocol

from ros2lab.diagnose.sources.beyond import OtherFiles
from ros2lab.diagnose.sources.node_source import Creation, NodeSources


class _End(Protocol):
    """What a publisher, a subscription, a server and a client have in common."""

    @property
    def creation(self) -> Creation: ...

    @property
    def sources(self) -> NodeSources: ...


class Partners:
    """What is known of a workspace beside its ends in Python: files that are not read, and packages that are used together."""

    def __init__(
        self, files: OtherFiles | None = None, groups: Collection[Collection[NodeSources]] = ()
    ) -> None:
        self._files = files or OtherFiles()
        self._groups = groups

    def may_be_elsewhere(self, name: str, *, is_whole: bool = False) -> bool:
        """Return whether a file that is not read names a topic or a service, so that it may have the other end."""
        return self._files.name(name, is_whole=is_whole)

    def are_together(self, end: _End, other: _End, there: Collection[_End] = ()) -> bool:
        """Return whether two ends are meant to run at the same time: two exercises may use one name.

        Args:
            end: the one.
            other: the other.
            there: all ends with their name; where there are no more than two, they are meant for each other.
        """
        pair = (end.sources, other.sources)
        is_pair = len(there) == 2 and all(found is end or found is other for found in there)
        is_joined = any(all(sources in group for sources in pair) for group in self._groups)
        return pair[0] is pair[1] or is_pair or is_joined


def made_in(end: _End) -> object:
    """Return the class that creates an end, or else the function or the file."""
    return end.creation.owner or end.creation.function or end.creation.source


def name_in(node: str, written: str) -> str:
    """Return the full name, without the first slash, of a topic or a service as a node writes it; empty if it is not known."""
    if written.startswith("~"):
        return f"{node}{written[1:]}" if node else ""
    space = "" if written.startswith("/") else node.rpartition("/")[0]
    return f"{space}/{written}".replace("//", "/").lstrip("/")
