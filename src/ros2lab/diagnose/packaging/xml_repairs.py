"""A manifest that cannot be read: changes of one sign, or of one tag, are tried until catkin_pkg takes it."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from itertools import islice

from ros2lab.manifest_words import NOT_TAKEN

_MOST = 20_000  # characters of a manifest that is looked at
_MOST_READ = 30_000_000  # characters in all that are read to try: fifty lines of a usual manifest are less
_SIGNS = ("/", '"', "<", ">")
# What a sign is written as where it is none of XML's own.
_WRITTEN = {"&": "&amp;", "<": "&lt;"}


def repaired(text: str) -> tuple[int, str] | None:
    """Return a line's number, and what to do there for the manifest to be read; None if no small change does it.

    Args:
        text: the manifest, which catkin_pkg does not take.
    """
    line = _line_of_fault(text)
    # What a document type declares may be a thousand times as long as its text; no package needs one.
    if line is None or not 0 < len(text) <= _MOST or "<!DOCTYPE" in text:
        return None
    begin = text.find("<?xml ")
    declaration, _, rest = text[begin:].partition("\n")
    if begin > 0 and _is_read(f"{declaration}\n{text[:begin]}{rest}"):
        line = text.count("\n", 0, begin) + 1
        return (
            line,
            f"move this line to the very beginning of the file: nothing may come before {declaration}",
        )
    lines = text.split("\n")
    # What is seen late was made before, and most often near.
    numbers = range(min(line, len(lines)) - 1, -1, -1)
    changes = ((number, changed) for number in numbers for changed in _changes(lines[number]))
    for number, changed in islice(changes, _MOST_READ // len(text)):
        if _is_read("\n".join([*lines[:number], changed, *lines[number + 1 :]])):
            return number + 1, f"write `{changed.strip()}`"
    return None


def _line_of_fault(text: str) -> int | None:
    try:
        ET.fromstring(text.encode())  # noqa: S314 -- a student's own file, without entities from elsewhere
    except ET.ParseError as error:
        return error.position[0]
    return None


def _changes(line: str) -> Iterator[str]:
    """Yield a line with one sign written out, added, or taken away, and with the tag closed that it opens."""
    for match in re.finditer(r"<!--(.*?)-->", line):
        said = re.sub(r"-{2,}", "-", match[1]).strip(" -")
        yield f"{line[: match.start()]}<!-- {said} -->{line[match.end() :]}"
    for match in re.finditer(r"&(?!\w+;)|<(?![\w!/?<])", line):
        yield line[: match.start()] + _WRITTEN[match[0]] + line[match.end() :]
    if opened := re.search(r"<(\w+)[^>/]*>[^<]*$", line):
        yield f"{line.rstrip()}</{opened[1]}>"
    for match in re.finditer(r"(.)(?=\1)", line):  # what was typed twice
        yield line[: match.start()] + line[match.end() :]
    for place in range(len(line) + 1):
        yield from (line[:place] + sign + line[place:] for sign in _SIGNS)


def _is_read(text: str) -> bool:
    # Late, as in `package`: few manifests need a repair.
    from catkin_pkg.package import InvalidPackage, parse_package_string

    try:
        ET.fromstring(text.encode())  # noqa: S314 -- as above
        parse_package_string(text)
    except (ET.ParseError, InvalidPackage, *NOT_TAKEN):
        return False
    return True
