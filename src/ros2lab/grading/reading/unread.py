"""What was not read in a submission, for a reader failed or met a limit: it costs and gains nothing, and the grade says so.

In the tests the failure itself is raised, so that our fault is seen.
"""

from __future__ import annotations

import ast
import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from ros2lab.diagnose import net
from ros2lab.diagnose.sources.python_source import DEEPEST, PythonSource, children
from ros2lab.grading.evidence import Evidence, Files

# What is read in Python files, by its name in `Files`.
OF_CODE = (
    *("sources", "sources_beside", "readme_names", "launched_programs", "hard_coded", "tests", "handlers"),
    *("compared", "depended_on", "idle", "ends", "ends_elsewhere", "declared", "findings"),
    *("branches", "ends_meant", "ends_left", "contents"),
)
# Of these, what each file adds its share to: where some of the code was read, its share stands for all.
OF_EACH_FILE = frozenset(("sources", "sources_beside", "readme_names", "launched_programs", "hard_coded"))
# What only helps to find a node, or to believe it: what a node does is seen all the same.
_SEEN_RUNNING = frozenset(
    (
        "ends",
        "ends_meant",
        "ends_left",
        "ends_elsewhere",
        "findings",
        "compared",
        "declared",
        "idle",
        "contents",
    )
)
Tell = Callable[[str, Any], None]
_Said = TypeVar("_Said")
_ROOM = 8  # levels, for what is neither an expression nor a statement
FACT = "fact "  # before the name of one that is told before all are known
NO_FAULT = "which is no fault of the submission"
FAILED = f"the grader has not read all that this rests on, {NO_FAULT}"


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


def is_open(source: PythonSource) -> bool:
    """Return whether a file, as `legible` returns it, does what was not read."""
    return source.tree is not None and (source.is_beyond or (isinstance(source, Legible) and source.hides))


def told(failed: Mapping[str, str]) -> list[str]:
    """Return sentences that say what was not read, and why."""
    rest = "What rests on it costs nothing, and is left to the instructor."
    return [f"Not read in full: {why} {rest}" for why in dict.fromkeys(failed.values())]


def as_far_as_possible(said: Iterable[_Said]) -> Iterator[_Said]:
    """Yield what is said until a fault of ours, if there is one: what is said of a grade does not change it."""
    try:
        yield from said
    except Exception as error:
        net.unjudged(error)


@dataclass(eq=False)
class Legible(PythonSource):
    """A Python file, without the expressions and statements in it that are nested too deeply for us.

    Attributes:
        hides: set by `tree`: whether these hold more than numbers and names, which open nothing.
    """

    hides: bool = field(default=False, init=False)

    def parsed(self) -> ast.Module:
        """Parse the text, and put something plain in the place of what lies too deep."""
        tree = super().parsed()
        level: list[ast.AST] = [tree]
        for depth in range(DEEPEST):
            if depth == DEEPEST - _ROOM:
                self.hides = any(map(_does, itertools.chain.from_iterable(map(ast.walk, level))))
            if depth > DEEPEST - _ROOM:
                for node in level:
                    vars(node).update({name: _cut(value) for name, value in ast.iter_fields(node)})
            level = [child for node in level for child in children(node)]
        return tree


def legible(sources: Iterable[PythonSource]) -> list[PythonSource]:
    """Return some files, those that are nested too deeply for us without what is."""
    return [
        Legible(source.name, source.shown, source.text, source.is_package, source.path)
        if source.tree is not None and source.is_beyond
        else source
        for source in sources
    ]


def _does(node: ast.AST) -> bool:
    is_text = isinstance(node, ast.Constant) and isinstance(node.value, str)
    return is_text or isinstance(node, (ast.stmt, ast.Call, ast.Lambda))


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
