"""Who has handed in the same as somebody else: names, comments, strings and the order of functions do not count.

What is compared is what Python reads: a statement a line, each name in plain letters. What is shown is what was written.
copydetect writes each file as a row of tokens without names, and chooses fingerprints of it (winnowing: Schleimer,
Wilkerson and Aiken, SIGMOD 2003). What is in the template, in the lessons or in a new package is taken out; what many of
the class have is told once, with those who have it, and makes no pairs.
"""

from __future__ import annotations

import ast
import contextlib
import copy
import io
import json
import re
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

from copydetect import CodeFingerprint, compare_files
from copydetect.utils import filter_code, hashed_kgrams

from portable_ros2.new_package import File, NewPackage
from ros2lab import course
from ros2lab.classroom.one import NO_PYTHON, parsed
from ros2lab.diagnose import net
from ros2lab.diagnose.sources.file_texts import decoded

NOISE = 25  # characters of the row of tokens; a match that is shorter is chance
WINDOW = 6  # of the fingerprints in it one is kept
FEW = 25  # fingerprints of a submission's own, below which nothing can be said
ALIKE = 0.5  # of the smaller submission's own fingerprints
MOST_PAIRS = 50
PATIENCE = 10.0  # s of CPU time for a submission, and for a pair; 1 MB of what somebody writes takes 5
COMMON = 0.25  # of a class: what more have makes no pairs,
COMMON_LEAST = 5  # and so many, at least
SAME = 0.7  # of those who have one mark or another and have both: then the two are of one piece
AROUND = 2  # lines around a passage that are shown
MOST_LINES = 400  # of a submission, in a pair


@dataclass(frozen=True)
class Line:
    """A line of a submission as it is shown; `number` is 0 where lines were left out."""

    number: int
    text: str
    is_alike: bool


@dataclass(frozen=True)
class Pair:
    """Two submissions that are alike.

    Attributes:
        first: key of a student.
        second: key of the other.
        share: of the smaller one's own fingerprints, 0 to 1.
        left: the first one's files, with what is alike; none where it takes longer to find than anybody's own does.
        right: the second one's.
    """

    first: str
    second: str
    share: float
    left: Mapping[str, list[Line]]
    right: Mapping[str, list[Line]]


@dataclass(frozen=True)
class Shared:
    """Code that many of a class have, and that neither the template, the lessons nor a new package has.

    Attributes:
        students: keys of those who have most of it.
        files: the first one's, with this code; none where it takes longer to find than anybody's own does.
    """

    students: Sequence[str]
    files: Mapping[str, list[Line]]


def pairs(
    classes_sources: Mapping[str, Mapping[str, str]],
    template: Iterable[str] = (),
    left_out: Callable[[str], None] = lambda _student: None,
    common: Callable[[str], None] = lambda _student: None,
    shared: Callable[[Shared], None] = lambda _code: None,
) -> list[Pair]:
    """Return the pairs of a class that are alike, the most alike first.

    Args:
        classes_sources: Python files by path, by the key of a student.
        template: texts that all were given; likeness to them, to the lessons, and to a new package, does not count.
        left_out: told the key of each student whose files take longer to be read than anybody's own do.
        common: told the key of each student of whose own files too little is left without what many of the class have.
        shared: told each piece of what many of the class have, the largest first.
    """
    marks = _marks(classes_sources, left_out)
    given = {mark for text in (*template, *_lessons(), *_created()) for mark in _all_marks(text)}
    whole = {student: _union(files.values()) - given for student, files in marks.items()}
    many = _held_by_many(whole)
    for piece in _pieces(many):
        students = [student for student in whole if len(whole[student] & piece) > len(piece) / 2]
        shown = (_only(marks[student], piece) for student in students[:2])
        shared(Shared(students, _in_time(*shown)[0]))
    own = {student: found - many.keys() for student, found in whole.items()}
    for student, left in own.items():
        if len(left) < FEW <= len(whole[student]):
            common(student)
    found = []
    for first, second in combinations(own, 2):
        smaller = min(len(own[first]), len(own[second]))
        share = len(own[first] & own[second]) / smaller if smaller >= FEW else 0.0
        if share >= ALIKE:
            found.append((share, first, second))
    found.sort(key=lambda pair: (-pair[0], pair[1:]))
    return [
        Pair(
            first,
            second,
            share,
            *_in_time(_only(marks[first], own[first]), _only(marks[second], own[second])),
        )
        for share, first, second in found[:MOST_PAIRS]
    ]


def most_alike(found: Iterable[Pair]) -> list[Pair]:
    """Return each pair once, by the largest share that is found, the most alike first."""
    best = {(pair.first, pair.second): pair for pair in sorted(found, key=lambda pair: pair.share)}
    return sorted(best.values(), key=lambda pair: (-pair.share, pair.first, pair.second))[:MOST_PAIRS]


def _held_by_many(whole: Mapping[str, Collection[int]]) -> dict[int, frozenset[str]]:
    """Return the marks that many of a class have, with those who have them."""
    holders = defaultdict[int, set[str]](set)
    for student, marks in whole.items():
        for mark in marks:
            holders[mark].add(student)
    many = max(COMMON_LEAST, COMMON * len(whole))
    return {mark: frozenset(students) for mark, students in holders.items() if len(students) > many}


def _pieces(many: Mapping[int, frozenset[str]]) -> list[set[int]]:
    """Return the marks that nearly the same students have, the most first; few ones are chance."""
    by_holders = defaultdict[frozenset[str], set[int]](set)
    for mark, students in many.items():
        by_holders[students].add(mark)
    found: dict[frozenset[str], set[int]] = {}
    for students, marks in sorted(by_holders.items(), key=lambda one: (-len(one[1]), sorted(one[0]))):
        alike = (held for held in found if len(students & held) > SAME * len(students | held))
        found.setdefault(next(alike, students), set()).update(marks)
    return sorted((marks for marks in found.values() if len(marks) >= FEW), key=len, reverse=True)


def _only(files: Mapping[str, _Fingerprint], marks: Collection[int]) -> dict[str, _Fingerprint]:
    """Return files with no fingerprints but these."""
    found = {path: copy.copy(file) for path, file in files.items()}
    for file in found.values():
        file.hashes = file.hashes & marks
        file.hash_idx = {mark: places for mark, places in file.hash_idx.items() if mark in marks}
    return found


def _marks(
    classes_sources: Mapping[str, Mapping[str, str]], left_out: Callable[[str], None]
) -> dict[str, dict[str, _Fingerprint]]:
    """Return the fingerprints of each student's files, but of those that take too long."""
    found = {}
    for student, sources in classes_sources.items():
        try:
            with net.bounded(PATIENCE):
                found[student] = {path: _Fingerprint(text) for path, text in sources.items()}
        except TimeoutError:
            left_out(student)
    return found


class _Fingerprint(CodeFingerprint):
    """The fingerprint of what Python reads in a text.

    Attributes:
        written: the lines of the text.
        places: by the lines of what Python reads, from 1: the first and the last line of the text at which each is written.
    """

    def __init__(self, text: str) -> None:
        self.written = text.splitlines()
        read, self.places = _as_read(text)
        # A character that fills two places in UTF-16 is no trouble; a NUL is for the lexer.
        plain = io.StringIO(read.replace("\0", " "))
        super().__init__("file.py", NOISE, WINDOW, fp=plain, language="python")


def _as_read(text: str) -> tuple[str, list[tuple[int, int]]]:
    """Return a text as Python reads it, and where its lines are written; of what is no Python, each block that is."""
    read, places, before = list[str](), [(1, 1)], 0
    for block in [text] if parsed(text) else re.split(r"\n(?=\S)", text):
        code, lines = _block_as_read(block)
        read.append(code)
        places += [(first + before, last + before) for first, last in lines]
        before += block.count("\n") + 1
    return "\n".join(read), places


def _block_as_read(text: str) -> tuple[str, list[tuple[int, int]]]:
    with contextlib.suppress(*NO_PYTHON):
        if tree := parsed(text):
            code = ast.unparse(tree)
            lines = [(1, 1)] * (code.count("\n") + 1)
            for written, read in zip(_statements(tree), _statements(ast.parse(code)), strict=True):
                inner = min((part.lineno for part in _statements(written)), default=0)
                last = max(written.lineno, inner - 1) if inner else written.end_lineno or 0
                held = slice(read.lineno - 1, read.end_lineno)
                lines[held] = [(written.lineno, last)] * len(lines[held])
            return code, lines
    return text, [(number, number) for number in range(1, text.count("\n") + 2)]


def _statements(node: ast.AST) -> Iterator[ast.stmt]:
    """Yield the statements in a node, those that hold others before these."""
    return (part for part in ast.walk(node) if isinstance(part, ast.stmt) and part is not node)


def _all_marks(text: str) -> set[int]:
    """Return all that a text may be known by, as it is written and as Python reads it."""
    rows = (filter_code(form, "file.py", "python")[0] for form in (text, _as_read(text)[0]))
    return {int(mark) for row in rows for mark in hashed_kgrams(row, NOISE)}


def _union(files: Iterable[_Fingerprint]) -> set[int]:
    return set().union(*(file.hashes for file in files))


def _lessons() -> Iterable[str]:
    """Yield the code of each lesson, with what its cells write into files."""
    for path in course.notebooks():
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        # The first line of a cell that writes a file is not Python.
        yield "\n".join(cell.partition("\n")[2] if cell.startswith("%%") else cell for cell in code)


def _created() -> Iterable[str]:
    """Yield the Python that `ros2 pkg create` writes."""
    package = NewPackage("new", "ament_python", 3, "", "", "", "", [], node="node")
    files = (step for step in package.steps if isinstance(step, File))
    yield from (package.render(file.template) for file in files if file.path.endswith(".py"))


def _in_time(
    first: Mapping[str, _Fingerprint], second: Mapping[str, _Fingerprint]
) -> tuple[dict[str, list[Line]], dict[str, list[Line]]]:
    """Return what is alike in two submissions; nothing where it takes too long to find."""
    try:
        with net.bounded(PATIENCE):
            return _side_by_side(first, second)
    except TimeoutError:
        return {}, {}


def _side_by_side(
    first: Mapping[str, _Fingerprint], second: Mapping[str, _Fingerprint]
) -> tuple[dict[str, list[Line]], dict[str, list[Line]]]:
    alike: tuple[dict[str, set[int]], dict[str, set[int]]] = {}, {}
    for left_path, left in first.items():
        for right_path, right in second.items():
            _, _, slices = compare_files(left, right)
            for path, file, cuts, lines in zip(
                (left_path, right_path), (left, right), slices, alike, strict=True
            ):
                if len(cuts):
                    lines.setdefault(path, set()).update(_lines_of(file, cuts))
    return _shown(first, alike[0]), _shown(second, alike[1])


def _lines_of(file: _Fingerprint, slices: Sequence[Sequence[int]]) -> Iterable[int]:
    """Yield the numbers, from 1, of the written lines in which passages lie."""
    text = file.raw_code
    for start, end in zip(*slices, strict=True):
        begin = text.count("\n", 0, int(start)) + 1
        after = begin + text.count("\n", int(start), max(int(start), int(end) - 1)) + 1
        for first, last in file.places[begin:after]:
            yield from range(first, last + 1)


def _shown(files: Mapping[str, _Fingerprint], alike: Mapping[str, set[int]]) -> dict[str, list[Line]]:
    left = MOST_LINES
    shown: dict[str, list[Line]] = {}
    for path, numbers in alike.items():
        near = {number + step for number in numbers for step in range(-AROUND, AROUND + 1)}
        lines: list[Line] = []
        for number, text in enumerate(files[path].written, start=1):
            if number in near and left > 0:
                lines.append(Line(number, text, number in numbers))
                left -= 1
            elif lines and lines[-1].number:
                lines.append(Line(0, "", is_alike=False))
        shown[path] = lines
    return shown


def template_texts(paths: Iterable[Path]) -> list[str]:
    """Return the texts of Python files, and of those in folders."""
    files = [file for path in paths for file in (sorted(path.rglob("*.py")) if path.is_dir() else [path])]
    return [decoded(file.read_bytes(), file) for file in files]
