"""Places in a student's files, as texts and as what stands there."""

from __future__ import annotations

import re
from pathlib import Path

from ros2lab.diagnose.error_text import Frame
from ros2lab.diagnose.finding import shown_path
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.python_says import Spot
from ros2lab.diagnose.python_source import read_source, read_text


def spot_at(place: str, look: Look | None) -> Spot:
    """Return what stands at a place such as `src/pk/pk/talk.py:12`; nothing if that names no line of a file."""
    file, _, line = place.rpartition(":")
    path = (look.root if look else Path()) / file
    is_known = line.isdigit() and path.is_file()
    return Spot(read_source(path, path.stem, file) if is_known else None, int(line) if is_known else 0)


def statement_around(place: str, look: Look) -> list[str]:
    """Return the places of all lines of the statement at a place; of the file, if that names no line."""
    if not place.rpartition(":")[2].isdigit():
        return [f"{place}:{n}" for n, _ in enumerate(read_text(look.root / place).splitlines(), 1)]
    spot = spot_at(place, look)
    return [f"{spot.source.shown}:{line}" for line in spot.lines] if spot.source else []


def is_setup(place: str) -> bool:
    """Return whether a place is in a setup.py."""
    return re.search(r"setup\.py(:|$)", place) is not None


def place_of(frames: list[Frame], look: Look | None) -> str:
    """Return the innermost place; of an installed copy, that of the student's own file."""
    if not frames:
        return ""
    file = frames[0].file
    for package in look.packages if look else ():
        for source in [*package.sources.values(), *([package.setup.source] if package.setup else [])]:
            if file == source.shown or file.endswith(f"/{'/'.join(Path(source.shown).parts[2:])}"):
                return f"{source.shown}:{frames[0].line}"
    return f"{shown_path(Path(file), look.root if look else None)}:{frames[0].line}"
