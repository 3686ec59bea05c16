"""What a build prints: its first real error, and its warnings."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path


def condensed(lines: Iterable[str]) -> Iterator[str]:
    """Yield a build's output without the padding of Python's warnings, and each of those once.

    A warning of setuptools takes fifteen lines and comes twice; what a student can act upon is kept as one: its first
    line, and where that names nothing, the first sentences of the box below.
    """
    told: set[str] = set()
    said: list[str] = []  # by the warning that is being read
    is_below_warning = is_boxed = False
    for line in lines:
        text = line.rstrip("\n")
        warning = _PYTHON_WARNING.match(text)
        if not warning and is_below_warning and text == "!!":
            is_boxed = not is_boxed
        elif not warning and is_below_warning and (is_boxed or text.startswith("  ") or not text):
            if is_boxed and said and "'" not in said[0]:
                said.append(text.strip(" *"))
        else:
            yield from _as_one(said, told)
            said, is_below_warning, is_boxed = [], warning is not None, False
            if warning is None:
                yield line
            elif message := _told_warning(warning):
                said = [message]
    yield from _as_one(said, told)


def _as_one(said: Sequence[str], told: set[str]) -> Iterator[str]:
    """Yield what a warning and the first paragraph of its box say, unless it was told before."""
    for first in said[:1]:
        box = itertools.dropwhile(lambda line: not line, said[1:])
        more = " ".join(itertools.takewhile(bool, box))
        message = f"{first}: {more}" if more else first
        if message not in told:
            told.add(message)
            yield f"warning: {message}\n"


_NOT_READ = (
    "colcon cannot read what setup.py tells it: leave print() out there, and give setup() plain values"
)


def first_error(lines: Sequence[str]) -> str | None:
    """Find the line that says what went wrong in what a package's build wrote to standard error.

    Args:
        lines: standard error, oldest line first.

    Returns:
        One line, with file and line number where Python tells them; None if nothing was written.
    """
    for line in lines:
        if _SETUPTOOLS_ERROR.match(line):
            return line.strip()
    for number, line in enumerate(lines):
        if line.startswith("CMake Error"):
            return _with_details(lines, number)
        if _COMPILER_ERROR.match(line):
            return line.strip()
    for number, line in enumerate(lines):
        if ends_traceback(lines, number):
            place = _place(lines[:number])
            is_of_colcon = "<unknown>" in place  # it evaluates what setup.py tells it
            return _NOT_READ if is_of_colcon else line.strip() + place
    return next((line.strip() for line in reversed(lines) if line.strip()), None)


def find_warnings(lines: Sequence[str]) -> list[str]:
    """List what deserves attention in the standard error of a package that was built."""
    found = []
    lines = [*condensed(lines)]
    for number, line in enumerate(lines):
        if _BYTE_COMPILE_ERROR.match(line):
            text = line.strip().removeprefix("Sorry: ")
            found.append(text if text.endswith(")") else text + _place(lines[:number]))
        elif line.startswith("CMake Warning"):
            found.append(_with_details(lines, number))
        elif _PLAIN_WARNING.match(line):
            found.append(line.strip().removeprefix("warning: "))
    return list(dict.fromkeys(found))


_PYTHON_WARNING = re.compile(r"\S.*?:\d+: (?P<category>\w*Warning): (?P<message>.*)")
_PLAIN_WARNING = re.compile(r"(?i)warning:|\S+:\d+(:\d+)?: warning:")
_BYTE_COMPILE_ERROR = re.compile(r"Sorry: \w+|SyntaxError: ")
_SETUPTOOLS_ERROR = re.compile(r"error: |error in .* setup command: ")
_COMPILER_ERROR = re.compile(r"\S+:\d+(:\d+)?: (fatal )?error: ")
_FRAME = re.compile(r'  File "(?P<file>.+?)", line (?P<line>\d+)')
_INSTALLED = re.compile(r"/(site|dist)-packages/|/lib/python\d|^<frozen")
# Said of what a package made by `ros2 pkg create`, or colcon itself, does: nothing a student has done wrong.
_NOT_THE_STUDENTS = ("'tests_require'", "setup.py install is deprecated", "easy_install", "setup.py develop")


def _told_warning(warning: re.Match[str]) -> str | None:
    message = warning["message"]
    return None if any(words in message for words in _NOT_THE_STUDENTS) else message


def ends_traceback(lines: Sequence[str], number: int) -> bool:
    """Return whether this line is the one below a traceback's frames: the exception itself."""
    line = lines[number]
    is_below = number > 0 and lines[number - 1].startswith("  ")
    frames = (text for text in reversed(lines[:number]) if not text.startswith("    "))
    return bool(line.strip()) and not line[0].isspace() and is_below and bool(_FRAME.match(next(frames, "")))


def _place(lines: Sequence[str]) -> str:
    """Return the innermost frame outside installed code, as ` (setup.py, line 4)`."""
    frames = [frame for line in lines if (frame := _FRAME.match(line))]
    own = [frame for frame in frames if not _INSTALLED.search(frame["file"])] or frames[-1:]
    return f" ({Path(own[-1]['file']).name}, line {own[-1]['line']})" if own else ""


def _with_details(lines: Sequence[str], number: int) -> str:
    """Join a CMake message's first line with the one that says what it is about."""
    text = lines[number].strip()
    if not text.endswith(":"):
        return text
    details = next((line.strip() for line in lines[number + 1 :] if line.strip()), "")
    return f"{text} {details}".strip()
