"""What programs noted while they ran, by its place in the sources."""

from __future__ import annotations

import ast
import contextlib
import json
import math
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.python_source import PythonSource

Spot = tuple[PythonSource, int, int, int, int]  # a file, the first line and column, and the last ones
Steps = tuple[str, list[tuple[int, Spot, str]]]  # a value before, and where it was set to which others
Value = tuple[str, str, int | None]  # an expression, what is shown of its value, and its length


@dataclass(frozen=True)
class Side:
    """One side of a test: its last value, whether it changed, and the least and the greatest number; empty if it did not.

    Attributes:
        way: 1 if it was a number that only rose, -1 if it only fell.
        nans: how often it was nan.
    """

    last: str
    has_changed: bool
    bounds: Sequence[str]
    way: int
    nans: int = 0

    def beside(self, other: Side) -> Side:
        """Return it with what another run noted of it."""
        numbers = sorted({*self.bounds, *other.bounds, *self._fixed, *other._fixed}, key=float)
        has_changed = self.has_changed or other.has_changed or self.last != other.last
        ways = {side.way for side in (self, other) if side.bounds}
        bounds = [numbers[0], numbers[-1]] if len(numbers) > 1 else []
        return Side(self.last, has_changed, bounds, sum(ways), self.nans + other.nans)

    @property
    def _fixed(self) -> list[str]:
        with contextlib.suppress(ValueError):
            return [] if self.bounds or not abs(float(self.last)) < math.inf else [self.last]
        return []


@dataclass(frozen=True)
class Test:
    """How often a test was true and false in all runs; `checks` is how often it was evaluated in the run that tells most.

    Attributes:
        near: the values of two floats that were nearly equal, but not quite.
    """

    held: int
    failed: int
    checks: int
    sides: Sequence[Side]
    near: Sequence[str] = ()

    def beside(self, other: Test) -> Test:
        """Return it with what another run noted of it."""
        first, second = sorted((self, other), key=lambda test: (len(test.near), test.checks), reverse=True)
        sides = [side.beside(beside) for side, beside in zip(first.sides, second.sides, strict=True)]
        return replace(first, held=self.held + other.held, failed=self.failed + other.failed, sides=sides)


@dataclass(frozen=True)
class Error:
    """An exception that was caught, or that ended a program.

    Attributes:
        handler: the place of the `except` that caught it; None if it ended the program.
        lines: the lines of the watched files in its traceback, the outermost first.
        values: the values in the last of these lines, the first time.
    """

    handler: Spot | None
    count: int
    kind: str
    message: str
    lines: Sequence[tuple[PythonSource, int]]
    values: Sequence[Value]

    def is_like(self, other: Error) -> bool:
        """Return whether another run has had it as well."""
        return (self.handler, self.kind, self.message, self.lines) == (
            other.handler,
            other.kind,
            other.message,
            other.lines,
        )

    @property
    def last_line(self) -> str:
        """Its last line in a traceback."""
        return f"{self.kind}: {self.message}" if self.message else self.kind

    @property
    def place(self) -> str:
        """The innermost line of a watched file; empty if there is none."""
        return self.lines[-1][0].at(self.lines[-1][1]) if self.lines else ""


@dataclass(frozen=True)
class ListSeen:
    """What became of a list in the calls of a callback in which it got something.

    Attributes:
        root: the callback.
        same: in how many calls, up to the last, it ended with the very items with which it had begun; -1 if not up to the last.
        length: how many items it had in the end.
        kind: the type of the object that it got last.
        held: how often it holds this one object, which it got again and again.
        contents: how many contents that object has had.
    """

    root: Spot
    same: int
    length: int
    kind: str
    held: int
    contents: int

    def beside(self, other: ListSeen) -> ListSeen:
        """Return it with what another run noted of it."""
        first = max(self, other, key=lambda seen: (seen.held, seen.same))
        same = -1 if -1 in (self.same, other.same) else max(self.same, other.same)
        return replace(first, same=same)


class Record:
    """What was noted in all runs.

    Attributes:
        marks: how often a statement came to its end, or an exit such as `return` was reached, a function was called,
            the body of a `for` or a `case` was entered.
        sources: the files of the workspace.
        classes: where the classes of the objects are written.
        paths: for each callback, and each name that ended in each call of it as it had begun: the value before, and the
            line in the callback, the place and the value each time that it was set; and in how many calls.
        lists: what became of a list that got something, by the place of that.
        texts: those that were compared with others, or looked for among them, each time with these.
        moving: the tests whose values still moved when a longer run ended; None if there was none.
    """

    def __init__(self, folder: Path, look: Look, moving: Collection[Spot] | None = None) -> None:
        self.moving = moving
        self.sources = [
            source for package in look.packages for source in look.sources(package).sources.values()
        ]
        self._by_text = {source.text: source for source in self.sources if source.path}
        self._by_path: dict[str, PythonSource | None] = {}
        self.tests: dict[Spot, Test] = {}
        self.marks = defaultdict[Spot, int](int)
        self.loops = defaultdict[Spot, list[Any]](list)
        self.errors: list[Error] = []
        self.classes: set[tuple[PythonSource, int]] = set()
        self.paths = defaultdict[tuple[Spot, str], list[tuple[Steps, int]]](list)
        self.lists: dict[Spot, ListSeen] = {}
        self.texts = set[tuple[str, tuple[str, ...]]]()
        self._changed = set[tuple[Spot, str]]()
        for file in sorted((folder / "noted").glob("*.json")):
            told = None
            with contextlib.suppress(OSError, ValueError):  # of a program that was killed while it wrote
                told = json.loads(file.read_text(encoding="utf-8"))
            if told is not None:
                self._read(told)

    def count(self, source: PythonSource, node: ast.AST) -> int:
        """Return how often what a node marks happened."""
        return self.marks.get(spot(source, node), 0)

    def marked(self, kinds: Any) -> Iterator[tuple[PythonSource, Any]]:
        """Yield the marked syntax nodes of some kinds."""
        for source in self._by_text.values():
            nodes = (node for node in source.nodes if isinstance(node, kinds))
            yield from ((source, node) for node in nodes if self.count(source, node))

    def test(self, source: PythonSource, node: ast.AST) -> Test | None:
        """Return what was noted of a test; None if it was never evaluated."""
        return self.tests.get(spot(source, node))

    def asked_beside(self, text: str) -> set[str]:
        """Return the texts that were looked for where a text was, or that it was compared with."""
        asked = ((left,) if text in others else others if text == left else () for left, others in self.texts)
        return {word for words in asked for word in words if word}

    def _read(self, told: Mapping[str, Any]) -> None:
        for place, (held, failed, sides, near) in self._spots(told["tests"]):
            test = Test(held, failed, held + failed, [Side(*side) for side in sides], near)
            self.tests[place] = test.beside(self.tests[place]) if place in self.tests else test
        for place, count in self._spots(told["marks"]):
            self.marks[place] += count
        for place, turns in self._spots(told["loops"]):
            self.loops[place] += turns
        for key, kind, message, count, lines, values in told["errors"]:
            handler = self._spot(key) if key else None
            places = [found[:2] for line in lines if (found := self._spot(line))]
            error = Error(handler, count, kind, message, places, [(*value,) for value in values])
            known = next((n for n, other in enumerate(self.errors) if other.is_like(error)), None)
            if known is None:
                self.errors.append(error)
            else:
                self.errors[known] = replace(self.errors[known], count=self.errors[known].count + count)
        self.classes |= {*self._classes(told["classes"])}
        self.texts |= {(text, (*others,)) for text, others in told["texts"]}
        self._read_changes(told)

    def _read_changes(self, told: Mapping[str, Any]) -> None:
        for key, name, paths in told["paths"]:
            if root := self._spot(key):
                self._changed |= set() if paths else {(root, name)}
                for (before, *steps), count in paths:
                    taken = [
                        (line, spot, value) for line, place, value in steps if (spot := self._spot(place))
                    ]
                    self.paths[root, name].append(((before, taken), count))
        for root_and_name in self._changed:
            self.paths.pop(root_and_name, None)
        for key, root_key, *numbers in told["lists"]:
            if (place := self._spot(key)) and (root := self._spot(root_key)):
                seen = ListSeen(root, *numbers)
                self.lists[place] = seen.beside(self.lists[place]) if place in self.lists else seen

    def _spots(self, told: Mapping[str, Any]) -> Iterator[tuple[Spot, Any]]:
        return ((place, found) for key, found in told.items() if (place := self._spot(key)))

    def _spot(self, key: str) -> Spot | None:
        path, *numbers = key.rsplit(":", 4)
        source = self._source(path)
        line, column, last, end = map(int, numbers)
        return (source, line, column, last, end) if source else None

    def _source(self, path: str) -> PythonSource | None:
        """Return the file that was run, which an installed copy has by its text."""
        if path not in self._by_path:
            self._by_path[path] = None
            with contextlib.suppress(OSError, UnicodeError):
                self._by_path[path] = self._by_text.get(Path(path).read_text(encoding="utf-8"))
        return self._by_path[path]

    def _classes(self, told: Sequence[Sequence[str]]) -> Iterator[tuple[PythonSource, int]]:
        for path, name in told:
            source = self._source(path)
            for node in source.tree.body if source else ():
                if source and isinstance(node, ast.ClassDef) and node.name == name:
                    yield source, node.lineno


def spot(source: PythonSource, node: Any) -> Spot:
    """Return the place of a syntax node."""
    return source, node.lineno, node.col_offset, node.end_lineno, node.end_col_offset


def node_at(place: tuple[Any, ...], kind: type[ast.expr]) -> ast.expr | None:
    """Return the expression of a kind at a place; None if there is none."""
    source: PythonSource = place[0]
    nodes = (node for node in source.nodes if isinstance(node, kind))
    return next((node for node in nodes if spot(source, node) == place), None)
