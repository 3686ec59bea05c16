"""What is wrong with a package.xml, in words that a beginner can look for."""

from __future__ import annotations

import re
from xml.parsers import expat

_TAG = re.compile(r"</?[\w:.-]+")


def fault_of(error: Exception, text: str) -> str:
    """Say why catkin_pkg does not take a package.xml.

    Args:
        error: catkin_pkg's.
        text: of the file.
    """
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    said = " ".join(lines[1:] or lines)  # the first one only names the file
    tags = _tags_that_differ(text)
    return f"{said}: <{tags[0]}> is open there, and {tags[1]}> comes" if tags else said


def _tags_that_differ(text: str) -> tuple[str, str] | None:
    """Return the tag that is open, and the one that comes in place of its end; None if that is not the fault."""
    opened: list[str] = []
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda name, _: opened.append(name)
    parser.EndElementHandler = lambda _: opened.pop()
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        line = text.splitlines()[error.lineno - 1] if error.lineno <= len(text.splitlines()) else ""
        tags = _TAG.findall(line[max(0, error.offset - 2) :])
        is_mismatch = expat.errors.messages[error.code] == expat.errors.XML_ERROR_TAG_MISMATCH
        return (opened[-1], tags[0]) if is_mismatch and opened and tags else None
    return None
