"""Repair an invalid manifest: try changes of one character or one tag until catkin_pkg accepts it."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from itertools import islice

from ros2lab.manifest_words import NOT_TAKEN

MOST = 20_000  # characters of the longest manifest to repair
_MOST_READ = 30_000_000  # characters to parse in all attempts; fifty lines of a usual manifest need fewer
_SIGNS = ("/", '"', "<", ">")
# How a character with a meaning in XML is written as plain text.
_WRITTEN = {"&": "&amp;", "<": "&lt;"}


def repaired(text: str) -> tuple[int, str] | None:
    """Return the number of a line and how to repair it; None if no small change makes the manifest valid.

    Args:
        text: the manifest, which catkin_pkg rejects.
    """
    line = _line_of_fault(text)
    # What a document type declares may expand a thousandfold, and no package needs one.
    if line is None or not 0 < len(text) <= MOST or "<!DOCTYPE" in text:
        return None
    begin = text.find("<?xml ")
    declaration, _, rest = text[begin:].partition("\n")
    if begin > 0 and is_read(f"{declaration}\n{text[:begin]}{rest}"):
        line = text.count("\n", 0, begin) + 1
        return (
            line,
            f"move this line to the very beginning of the file: nothing may come before {declaration}",
        )
    lines = text.split("\n")
    # A fault is noticed after the place where it was made, mostly shortly after.
    numbers = range(min(line, len(lines)) - 1, -1, -1)
    changes = ((number, changed) for number in numbers for changed in _changes(lines[number]))
    for number, changed in islice(changes, _MOST_READ // len(text)):
        if is_read("\n".join([*lines[:number], changed, *lines[number + 1 :]])):
            return number + 1, f"write `{changed.strip()}`"
    return None


def _line_of_fault(text: str) -> int | None:
    try:
        ET.fromstring(text.encode())  # noqa: S314 -- a student's own file, without entities from elsewhere
    except ET.ParseError as error:
        return error.position[0]
    return None


def _changes(line: str) -> Iterator[str]:
    """Yield a line with one character escaped, added or removed, or with the tag closed that it opens."""
    for match in re.finditer(r"<!--(.*?)-->", line):
        said = re.sub(r"-{2,}", "-", match[1]).strip(" -")
        yield f"{line[: match.start()]}<!-- {said} -->{line[match.end() :]}"
    for match in re.finditer(r"&(?!\w+;)|<(?![\w!/?<])", line):
        yield line[: match.start()] + _WRITTEN[match[0]] + line[match.end() :]
    if opened := re.search(r"<(\w+)[^>/]*>[^<]*$", line):
        yield f"{line.rstrip()}</{opened[1]}>"
    for match in re.finditer(r"(.)(?=\1)", line):  # a character typed twice
        yield line[: match.start()] + line[match.end() :]
    for place in range(len(line) + 1):
        yield from (line[:place] + sign + line[place:] for sign in _SIGNS)


def is_read(text: str) -> bool:
    """Return whether catkin_pkg accepts a manifest."""
    # A late import, as in `package`: few manifests need a repair.
    from catkin_pkg.package import InvalidPackage, parse_package_string

    try:
        ET.fromstring(text.encode())  # noqa: S314 -- as above
        parse_package_string(text)
    except (ET.ParseError, InvalidPackage, *NOT_TAKEN):
        return False
    return True
