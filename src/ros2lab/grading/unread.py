"""What a reader of ours has failed to read in a submission: it is no loss, no gain, and it is said.

In the tests the failure itself is raised, for it is a fault of ours that must be seen.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from ros2lab.diagnose import net
from ros2lab.grading.evidence import Evidence, Files

FAILED = "the grader itself has failed to read a file, which is no fault of the submission"


def read_all(readers: Mapping[str, Callable[[], Any]]) -> tuple[dict[str, Any], dict[str, str]]:
    """Return what readers have read, by their names, and why those that are missing in it have failed.

    Raises:
        MemoryError, RecursionError, OSError: where nobody can follow what is read.
    """
    found: dict[str, Any] = {}
    failed: dict[str, str] = {}
    for name, read in readers.items():
        try:
            found[name] = read()
        except Exception as error:
            if not net.is_ours(error):
                raise
            failed[name] = net.unjudged(error).cause
    return found, failed


def told(failed: Mapping[str, str]) -> list[str]:
    """Say of readers that have failed what was not read, and why."""
    return [
        f"Not read: {', '.join(name for name in failed if failed[name] == why)}. {why} What rests on it costs nothing, "
        "and is left to the instructor."
        for why in dict.fromkeys(failed.values())
    ]


class Noted(Files):
    """Facts of files, some of which could not be read; it notes when it is asked for one of those."""

    missed: set[str]

    def __getattribute__(self, name: str) -> Any:
        """Return a fact."""
        value = object.__getattribute__(self, name)
        if name != "unread" and name in object.__getattribute__(self, "unread"):
            object.__getattribute__(self, "missed").add(name)
        return value


def noted(evidence: Evidence) -> Evidence:
    """Return evidence that notes when it is asked for a fact that could not be read."""
    if not evidence.files.unread:
        return evidence
    facts = Noted(**vars(evidence.files))
    object.__setattr__(facts, "missed", set())
    return replace(evidence, files=facts)


@contextmanager
def missing(evidence: Evidence) -> Iterator[set[str]]:
    """Give the set into which come the facts that are asked for meanwhile and could not be read."""
    facts = evidence.files
    before = facts.missed if isinstance(facts, Noted) else set()
    asked: set[str] = set()
    if isinstance(facts, Noted):
        object.__setattr__(facts, "missed", asked)
    try:
        yield asked
    finally:
        before |= asked
