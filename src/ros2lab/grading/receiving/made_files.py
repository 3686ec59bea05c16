"""Files that Python or a build makes from what somebody wrote, recognised by their content."""

from __future__ import annotations

import contextlib
import itertools
import os
from collections import defaultdict
from collections.abc import Iterable, Set
from pathlib import Path, PurePosixPath

from ros2lab.grading.receiving.clean_copy import CHUNK, MOST_MEMBERS, CleanCopy, Meter, is_of_a_build, opened
from ros2lab.grading.receiving.unpacking import in_archive

_NO_MODULES = frozenset(("__init__.py", "setup.py", "conftest.py"))
_UNCHECKED = [number.to_bytes(4, "little") for number in (0, 1, 3)]  # PEP 552
TIMES = 10  # that an archive's size counts: reading all archives may cost no more than unpacking one
_ELF, _ENTRY = b"\x7fELF", b"PyInit_"


def note_made(copy: CleanCopy) -> None:
    """Note the files beside a package that Python or a build made, whatever their names; they stay."""
    paths = sorted(Path(parent, name) for parent, _, names in os.walk(copy.root) for name in names)
    modules = {path.name for path in paths if path.suffix == ".py"} - _NO_MODULES
    meter = Meter()
    for path in paths:
        with contextlib.suppress(Exception):  # hostile bytes make the readers of archives raise anything
            if _is_compiled(path) or _is_packed(path, modules, meter):
                copy.note("made", str(path.relative_to(copy.root)))


def _is_compiled(path: Path) -> bool:
    """Return whether a file is compiled Python, or a module that a compiler made."""
    with opened(path) as file:
        start = file.read(CHUNK)
        if not start.startswith(_ELF):
            return start[2:4] == b"\r\n" and start[4:8] in _UNCHECKED
        return _ENTRY in start + file.read()


def _is_packed(path: Path, modules: Set[str], meter: Meter) -> bool:
    """Return whether an archive, such as a wheel, holds what a build made of some modules."""
    with opened(path) as file:
        if not file.read(2).startswith((b"PK", b"\x1f\x8b", b"BZ", b"\xfd7")):
            return False
    meter.add(TIMES * path.stat().st_size)
    members = itertools.islice(in_archive(path, meter), MOST_MEMBERS)
    names = [PurePosixPath(member.name) for member in members]
    return not modules.isdisjoint(name.name for name in names) and _are_of_a_build(names)


def _are_of_a_build(names: Iterable[PurePosixPath]) -> bool:
    """Return whether some files lie together as only a build, or Python's packaging, leaves them."""
    folders = defaultdict[PurePosixPath, set[str]](set)
    for name in names:
        folders[name.parent].add(name.name)
    return any("PKG-INFO" in inside or is_of_a_build(inside) for inside in folders.values())
