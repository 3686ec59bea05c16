"""Recognizes messages and warnings of the student's own code, which are no errors of ROS or Python."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import Frame, own_frames
from ros2lab.diagnose.printed.transcript import WARNING
from ros2lab.diagnose.sources.python_source import PythonSource, read_source

_GIVES_ONE = re.compile(r"\s*(?:warnings\.)?warn\(")
_SHORTEST = 8  # characters of a text that is recognized
_VALUE = re.compile(r"%[-+ 0#]*\d*(?:\.\d+)?[a-zA-Z]|\{[^{}]*\}")  # a placeholder in a format string


def without_own_warnings(text: str, look: Look | None) -> str:
    """Remove the warnings of the student's own code from a text, each with the line of code below it."""
    lines = text.splitlines()
    left, n = [], 0
    while n < len(lines):
        warning = WARNING.match(lines[n])
        below = lines[n + 1] if n + 1 < len(lines) else ""
        if warning and _is_own(warning, below, look):
            n += 1 + below.startswith("  ")
            continue
        left.append(lines[n])
        n += 1
    return text if len(left) == len(lines) else "\n".join(left)


def own_words(line: str, look: Look | None) -> Finding | None:
    """Say where the student's own code contains the text of a line; None if it does not."""
    said = [
        (text, source.at(node))
        for package in (look.packages if look else ())
        for source in package.sources.values()
        for text, node in _texts(source)
        if text in line
    ]
    if not said:
        return None
    text, place = max(said, key=lambda text_and_place: len(text_and_place[0]))
    return Finding(
        SAID,
        f"{text!r} is a message of your own code, not an error from ROS or Python.",
        place,
        "if it should not appear here, check the condition above this line and the value it receives",
    )


def _is_own(warning: re.Match[str], below: str, look: Look | None) -> bool:
    if not own_frames([Frame(warning["file"], int(warning["line"]))]):
        return False
    if _GIVES_ONE.match(below):
        return True
    # With a stacklevel, a warning names the line of the caller.
    return any(
        text in warning["message"] for source in _files(warning["file"], look) for text, _ in _texts(source)
    )


def _files(file: str, look: Look | None) -> Iterator[PythonSource]:
    path = (look.root if look else Path()) / file
    if path.is_file():
        yield read_source(path, path.stem, file)
    for package in look.packages if look else ():
        yield from package.sources.values()


def _texts(source: PythonSource) -> Iterator[tuple[str, ast.AST]]:
    """Yield the longer strings of a file with their nodes; of format strings, the parts between values."""
    if source.tree is None or source.fault:
        return
    for node in source.nodes:
        whole = node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""
        for text in map(str.strip, _VALUE.split(whole)):
            if len(text) >= _SHORTEST:
                yield text, node
