"""Who has handed in the same as somebody else: names, comments, strings and the order of functions do not count.

copydetect writes each file as a row of tokens without names, and chooses fingerprints of it (winnowing: Schleimer,
Wilkerson and Aiken, SIGMOD 2003). What is in the template, in the lessons, or with many of the class, is taken out.
"""

from __future__ import annotations

import contextlib
import io
import json
import signal
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

from copydetect import CodeFingerprint, compare_files
from copydetect.utils import filter_code, hashed_kgrams

from ros2lab import course

NOISE = 25  # characters of the row of tokens; a match that is shorter is chance
WINDOW = 6  # of the fingerprints in it one is kept
FEW = 25  # fingerprints of a submission's own, below which nothing can be said
ALIKE = 0.5  # of the smaller submission's own fingerprints
MOST_PAIRS = 50
PATIENCE = 10.0  # s of CPU time for a submission, and for a pair; 1 MB of what somebody writes takes 5
COMMON = 0.25  # of a class: what more have is nobody's own,
COMMON_LEAST = 5  # and so many, at least
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


def pairs(
    classes_sources: Mapping[str, Mapping[str, str]],
    template: Iterable[str] = (),
    left_out: Callable[[str], None] = lambda _student: None,
    common: Callable[[str], None] = lambda _student: None,
) -> list[Pair]:
    """Return the pairs of a class that are alike, the most alike first.

    Args:
        classes_sources: Python files by path, by the key of a student.
        template: texts that all were given; likeness to them, and to the lessons, does not count.
        left_out: told the key of each student whose files take longer to be read than anybody's own do.
        common: told the key of each student of whose own files too little is left without what many of the class have.
    """
    marks = _marks(classes_sources, left_out)
    given = {mark for text in (*template, *_lessons()) for mark in _all_marks(text)}
    holders = Counter(mark for files in marks.values() for mark in _union(files.values()))
    many = max(COMMON_LEAST, COMMON * len(marks))
    known = given | {mark for mark, count in holders.items() if count > many}
    for student, files in marks.items():
        if len(_union(files.values()) - known) < FEW <= len(_union(files.values()) - given):
            common(student)
    for files in marks.values():
        for file in files.values():
            file.hashes = file.hashes - known
            file.hash_idx = {mark: places for mark, places in file.hash_idx.items() if mark not in known}
    own = {student: _union(files.values()) for student, files in marks.items()}
    found = []
    for first, second in combinations(own, 2):
        smaller = min(len(own[first]), len(own[second]))
        share = len(own[first] & own[second]) / smaller if smaller >= FEW else 0.0
        if share >= ALIKE:
            found.append((share, first, second))
    found.sort(key=lambda pair: (-pair[0], pair[1:]))
    return [
        Pair(first, second, share, *_in_time(marks[first], marks[second]))
        for share, first, second in found[:MOST_PAIRS]
    ]


def _marks(
    classes_sources: Mapping[str, Mapping[str, str]], left_out: Callable[[str], None]
) -> dict[str, dict[str, CodeFingerprint]]:
    """Return the fingerprints of each student's files, but of those that take too long."""
    found = {}
    for student, sources in classes_sources.items():
        try:
            with _bounded(PATIENCE):
                found[student] = {path: _fingerprint(text) for path, text in sources.items()}
        except TimeoutError:
            left_out(student)
    return found


@contextlib.contextmanager
def _bounded(seconds: float) -> Iterator[None]:
    """Raise a TimeoutError in what takes more CPU time; in another thread than the main one it has no bound."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def end(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGVTALRM, end)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


def _fingerprint(text: str) -> CodeFingerprint:
    # A character that fills two places in UTF-16 is no trouble; a NUL is for the lexer.
    return CodeFingerprint(
        "file.py", NOISE, WINDOW, fp=io.StringIO(text.replace("\0", " ")), language="python"
    )


def _all_marks(text: str) -> set[int]:
    tokens, _ = filter_code(text, "file.py", "python")
    return {int(mark) for mark in hashed_kgrams(tokens, NOISE)}


def _union(files: Iterable[CodeFingerprint]) -> set[int]:
    return set().union(*(file.hashes for file in files))


def _lessons() -> Iterable[str]:
    """Yield the code of each lesson, with what its cells write into files."""
    for path in course.notebooks():
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        # The first line of a cell that writes a file is not Python.
        yield "\n".join(cell.partition("\n")[2] if cell.startswith("%%") else cell for cell in code)


def _in_time(
    first: Mapping[str, CodeFingerprint], second: Mapping[str, CodeFingerprint]
) -> tuple[dict[str, list[Line]], dict[str, list[Line]]]:
    """Return what is alike in two submissions; nothing where it takes too long to find."""
    try:
        with _bounded(PATIENCE):
            return _side_by_side(first, second)
    except TimeoutError:
        return {}, {}


def _side_by_side(
    first: Mapping[str, CodeFingerprint], second: Mapping[str, CodeFingerprint]
) -> tuple[dict[str, list[Line]], dict[str, list[Line]]]:
    alike: tuple[dict[str, set[int]], dict[str, set[int]]] = {}, {}
    for left_path, left in first.items():
        for right_path, right in second.items():
            _, _, slices = compare_files(left, right)
            for path, file, cuts, lines in zip(
                (left_path, right_path), (left, right), slices, alike, strict=True
            ):
                if len(cuts):
                    lines.setdefault(path, set()).update(_lines_of(file.raw_code, cuts))
    return _shown(first, alike[0]), _shown(second, alike[1])


def _lines_of(text: str, slices: Sequence[Sequence[int]]) -> Iterable[int]:
    """Yield the numbers, from 1, of the lines in which passages lie."""
    for start, end in zip(*slices, strict=True):
        begin = text.count("\n", 0, int(start)) + 1
        yield from range(begin, begin + text.count("\n", int(start), max(int(start), int(end) - 1)) + 1)


def _shown(files: Mapping[str, CodeFingerprint], alike: Mapping[str, set[int]]) -> dict[str, list[Line]]:
    left = MOST_LINES
    shown: dict[str, list[Line]] = {}
    for path, numbers in alike.items():
        near = {number + step for number in numbers for step in range(-AROUND, AROUND + 1)}
        lines: list[Line] = []
        for number, text in enumerate(files[path].raw_code.splitlines(), start=1):
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
    return [file.read_text(encoding="utf-8", errors="replace") for file in files]
