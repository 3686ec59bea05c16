"""What was not read in a submission, for a reader failed or met a limit: it costs and gains nothing, and the grade says so.

In the tests the failure itself is raised, so that our fault is seen.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

from ros2lab.diagnose import net
from ros2lab.diagnose.sources.python_source import DEEPEST, PythonSource, children
from ros2lab.grading.evidence import Evidence, Files

# What is read in Python files, by its name in `Files`.
OF_CODE = (
    *("sources", "sources_beside", "readme_names", "launched_programs", "hard_coded", "tests", "handlers"),
    *("clock_readers", "compared", "depended_on", "idle", "ends", "ends_elsewhere", "declared", "findings"),
    "ends_meant",
)
# Of these, what each file adds its share to: where some of the code was read, its share stands for all.
OF_EACH_FILE = frozenset(("sources", "sources_beside", "readme_names", "launched_programs", "hard_coded"))
# What only helps to find a node, or to believe it: what a node does is seen all the same.
_SEEN_RUNNING = frozenset(
    ("ends", "ends_meant", "ends_elsewhere", "findings", "compared", "declared", "idle", "clock_readers")
)
Tell = Callable[[str, Any], None]
_ROOM = 8  # levels, for what is neither an expression nor a statement
FACT = "fact "  # before the name of one that is told before all are known
FAILED = "the grader has not read all that this rests on, which is no fault of the submission"


def read_all(
    readers: Mapping[str, Callable[[], Any]], tell: Tell = lambda _name, _value: None
) -> tuple[dict[str, Any], dict[str, str]]:
    """Return the readers' results by name, and by name why the other readers failed.

    Each is told as soon as it is known, those that are read in code last: a limit may end the reading at any time.

    Raises:
        MemoryError, RecursionError, OSError: if the submission itself cannot be read.
    """
    found: dict[str, Any] = {}
    failed: dict[str, str] = {}
    for name, read in sorted(readers.items(), key=lambda reader: reader[0] in OF_CODE):
        try:
            found[name] = read()
            tell(name, found[name])
        except Exception as error:
            if not net.is_ours(error):
                raise
            failed[name] = net.unjudged(error).cause
    return found, failed


def told(failed: Mapping[str, str]) -> list[str]:
    """Return sentences that say what was not read, and why."""
    return [
        f"Not read: {', '.join(name for name in failed if failed[name] == why)}. {why} What rests on it costs nothing, "
        "and is left to the instructor."
        for why in dict.fromkeys(failed.values())
    ]


@dataclass(eq=False)
class Legible(PythonSource):
    """A Python file, without the expressions and statements in it that are nested too deeply for us."""

    def parsed(self) -> ast.Module:
        """Parse the text, and put something plain in the place of what lies too deep."""
        tree = super().parsed()
        level: list[ast.AST] = [tree]
        for depth in range(DEEPEST):
            if depth > DEEPEST - _ROOM:
                for node in level:
                    vars(node).update({name: _cut(value) for name, value in ast.iter_fields(node)})
            level = [child for node in level for child in children(node)]
        return tree


def legible(sources: Collection[PythonSource]) -> list[PythonSource]:
    """Return some files, those that are nested too deeply for us without what is."""
    return [
        Legible(source.name, source.shown, source.text, source.is_package, source.path)
        if source.tree is not None and source.is_beyond
        else source
        for source in sources
    ]


def _cut(value: Any) -> Any:
    match value:
        case [*values]:
            return [_cut(inner) for inner in values]
        case ast.expr():
            return ast.copy_location(ast.Constant(None), value)
        case ast.stmt():
            return ast.copy_location(ast.Pass(), value)
    return value


class Noted(Files):
    """Facts of files that record in `missed` each access to a fact that was not read and that no run shows."""

    missed: set[str]

    def __getattribute__(self, name: str) -> Any:
        """Return a fact."""
        value = object.__getattribute__(self, name)
        if name not in _SEEN_RUNNING and name != "unread" and name in object.__getattribute__(self, "unread"):
            object.__getattribute__(self, "missed").add(name)
        return value


def noted(evidence: Evidence) -> Evidence:
    """Return evidence that records each access to a fact that could not be read."""
    if not evidence.files.unread:
        return evidence
    facts = Noted(**vars(evidence.files))
    object.__setattr__(facts, "missed", set())
    return replace(evidence, files=facts)


@contextmanager
def missing(evidence: Evidence) -> Iterator[set[str]]:
    """Yield a set that collects the unread facts that are accessed inside the context."""
    facts = evidence.files
    before = facts.missed if isinstance(facts, Noted) else set()
    asked: set[str] = set()
    if isinstance(facts, Noted):
        object.__setattr__(facts, "missed", asked)
    try:
        yield asked
    finally:
        before |= asked
