"""Places in a student's files, and the code there."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ros2lab.diagnose.finding import shown_path
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorReport, Frame, own_frames
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    assigned_to,
    own_nodes,
    read_source,
    read_text,
)
from ros2lab.diagnose.sources.spelling import with_article
from ros2lab.diagnose.sources.static_value import expression

_NO_FILE = PythonSource("", "", "")


@dataclass(frozen=True)
class Spot:
    """A line of the student's code where an error occurred.

    Attributes:
        source: the file; None if it cannot be read.
        is_innermost: whether the error was raised in this line itself, not in a library that it calls.
        part: the part of the line that Python marks.
        workspace: the files of the workspace, as far as they are known.
    """

    source: PythonSource | None
    line: int
    is_innermost: bool = True
    part: str = ""
    workspace: Collection[PythonSource] = ()

    @property
    def file(self) -> PythonSource:
        """The file; an empty one if it cannot be read."""
        return self.source or _NO_FILE

    @property
    def place(self) -> str:
        """The place of the line; empty if the file cannot be read."""
        return self.source.at(self.line) if self.source else ""

    @property
    def marked(self) -> ast.AST | None:
        """The expression that Python marks in the line; None if it marks none, or the whole line."""
        part = expression(self.part) if self.part else None
        wanted = ast.unparse(part) if part else ""
        return next((n for n in self.nodes if isinstance(n, ast.expr) and ast.unparse(n) == wanted), None)

    @property
    def nodes(self) -> list[ast.AST]:
        """The syntax nodes that begin on the line."""
        return [node for node in self.file.nodes if getattr(node, "lineno", 0) == self.line]

    @property
    def whole(self) -> list[ast.AST]:
        """The syntax nodes that begin on the lines of its statement, line by line."""
        return [node for line in self.lines for node in Spot(self.source, line).nodes]

    @property
    def calls(self) -> list[ast.Call]:
        """The calls that begin on the line."""
        return [node for node in self.nodes if isinstance(node, ast.Call)]

    @property
    def text(self) -> str:
        """The text of the line."""
        lines = self.file.text.splitlines()
        return lines[self.line - 1].strip() if 0 < self.line <= len(lines) else ""

    @property
    def function(self) -> Function | None:
        """The innermost function around the line."""
        return self.file.function_at(self.line)

    @property
    def lines(self) -> range:
        """The lines of the statement at the line; of an `if` or a `def`, those before its body."""
        best = range(self.line, self.line + 1)
        for node in self.file.around(self.line, ast.stmt):
            body = getattr(node, "body", None)
            end = body[0].lineno if body else (node.end_lineno or 0) + 1
            if self.line < end:
                best = range(node.lineno, end)
        return best

    def assigned(self, text: str) -> list[ast.expr]:
        """Return the values that the file assigns to a name or an attribute such as `self.count`; to a local name, its function's."""
        function = self.function if text.isidentifier() else None
        local = assigned_to(own_nodes(function), text) if function else []
        return local or assigned_to(self.file.nodes, text)

    def holds(self, name: str) -> list[str]:
        """Return the expressions before `.name` in the line, the shortest first."""
        found = [ast.unparse(n.value) for n in self.nodes if isinstance(n, ast.Attribute) and n.attr == name]
        return sorted(found, key=len)


def spot_at(place: str, look: Look) -> Spot:
    """Return the spot at a place such as `src/pk/pk/talk.py:12`; without a source if there is none."""
    file, _, line = place.rpartition(":")
    source = source_of(file, look) if line.isdigit() else None
    return Spot(source, int(line) if source else 0, workspace=tuple(look.files))


def source_of(shown: str, look: Look) -> PythonSource | None:
    """Return a file of the workspace by its path as it is shown; None if there is none."""
    path = look.root / shown
    known = next((source for source in look.files if source.shown == shown), None)
    return known or (read_source(path, path.stem, shown) if path.is_file() else None)


def spot_of(report: ErrorReport | None, look: Look) -> Spot:
    """Return the innermost line of the student's in a traceback; without a source if there is none."""
    frames = own_frames(report.frames) if report else []
    if report is None or not frames:
        return Spot(None, 0)
    is_innermost = frames[0] is report.frames[-1]
    return replace(spot_at(place_of(frames, look), look), part=frames[0].part, is_innermost=is_innermost)


def statement_around(place: str, look: Look) -> list[str]:
    """Return the places of all lines of the statement at a place; of the whole file if it has no line."""
    if not place.rpartition(":")[2].isdigit():
        return [f"{place}:{n}" for n, _ in enumerate(read_text(look.root / place).splitlines(), 1)]
    spot = spot_at(place, look)
    return [f"{spot.source.shown}:{line}" for line in spot.lines] if spot.source else []


def is_setup(place: str) -> bool:
    """Return whether a place is in a setup.py."""
    return re.search(r"setup\.py(:|$)", place) is not None


def place_of(frames: Sequence[Frame], look: Look) -> str:
    """Return the place of the innermost frame; an installed copy counts as the student's own file."""
    if not frames:
        return ""
    file = frames[0].file
    for package in look.packages:
        for source in [*package.sources.values(), *([package.setup.source] if package.setup else [])]:
            if file == source.shown or file.endswith(f"/{'/'.join(Path(source.shown).parts[2:])}"):
                return f"{source.shown}:{frames[0].line}"
        if (package.folder / file).is_file() and not Path(file).is_absolute():
            return f"{package.shown(file)}:{frames[0].line}"  # pytest names a test relative to its package
    return f"{shown_path(Path(file), look.root)}:{frames[0].line}"


def kind_in_words(name: str) -> str:
    """Return the name of a Python type in words, such as `a string`."""
    return _KINDS.get(name, with_article(name))


# Where the name of a type is not its word.
_KINDS = {
    **{"str": "a string", "int": "an integer", "float": "a number", "bool": "True or False"},
    **{"sequence": "a string", "NoneType": "None", "type": "a class"},
}
