"""What the words in a package.xml tell, and what is wrong with it, in words that a beginner can look for."""

from __future__ import annotations

import re
from collections.abc import Iterator
from xml.parsers import expat

# What catkin_pkg raises besides its InvalidPackage: for a format that is no number, or a condition that cannot be read;
# for a format of the future; for tags in hundreds of others.
NOT_TAKEN: tuple[type[Exception], ...] = (ValueError, AssertionError, RecursionError)
# The keys of modules whose names differ from them; a ROS package is its own key.
KEYS = {
    "PIL": "python3-pil",
    "cv2": "python3-opencv",
    "numpy": "python3-numpy",
    "pytest": "python3-pytest",
    "serial": "python3-serial",
    "tf2_ros": "tf2_ros_py",
    "yaml": "python3-yaml",
}
_TAG = re.compile(r"</?[\w:.-]+")
_TODO = re.compile(r"\bTODO\b|\bFIXME\b|\b[Tt]odo:")  # in Spanish `todo` is a word
_TEMPLATE = "TODO: Package description"  # as `ros2 pkg create` writes it
_LETTERS = re.compile(r"[^\W\d_]+")
FEWEST_WORDS = 2  # of what tells something
# What a template or a tutorial has for a name or an address speaks to its reader.
_TO_READER = re.compile(r"you@|[Yy]our(?![a-z])|YOUR(?![a-z])")


def is_to_be_done(text: str) -> bool:
    """Return whether a text says of itself that it is still to be written."""
    return _TODO.search(text) is not None


def names_its_reader(text: str) -> bool:
    """Return whether a name or an address is one to fill in, such as `Your Name` or `you@email.com`."""
    return _TO_READER.match(text.strip()) is not None


def describes(text: str, package: str) -> bool:
    """Return whether a description tells something of a package: at least two words that its name does not hold.

    Words of one letter, and those that `ros2 pkg create` has put there, tell nothing.
    """
    name = {*words_in(package)}
    told = {*words_in(text)} - name - {"".join(words_in(package))} - {*words_in(_TEMPLATE)}
    return not is_to_be_done(text) and len(told) >= FEWEST_WORDS


def words_in(text: str) -> Iterator[str]:
    """Yield the words of a text, and each letter of a script without capitals: some write no spaces between words."""
    for letters in _LETTERS.findall(text.casefold()):
        if letters.upper() == letters:
            yield from letters
        elif len(letters) > 1:
            yield letters


def fault_of(error: Exception, text: str) -> str:
    """Say why catkin_pkg does not take a package.xml.

    Args:
        error: catkin_pkg's.
        text: of the file.
    """
    if isinstance(error, RecursionError):
        return "its tags are nested hundreds of levels deep"
    if isinstance(error, ValueError) and "int()" in str(error):
        return 'the format in <package format="3"> must be a number'
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    said = " ".join(lines[1:] or lines)  # the first one only names the file
    tags = _tags_that_differ(text)
    return f"{said}: <{tags[0]}> is not closed before {tags[1]}>" if tags else said


def _tags_that_differ(text: str) -> tuple[str, str] | None:
    """Return the tag that is open, and the one that comes instead of its end; None if that is not the fault."""
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
