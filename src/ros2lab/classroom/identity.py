"""What a grade depends on, as digests: the submission, the assignment, the grader, and the rubric."""

from __future__ import annotations

import hashlib
import importlib.metadata
import os
import stat
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import resources
from pathlib import Path

import portable_ros2
import ros2lab
from ros2lab import __version__, assignments
from ros2lab.grading.receiving.clean_copy import MOST_BYTES, TOOLS_NAMES, is_too_long, opened

_TOOLS = ("colcon-core", "ros-rclpy", "setuptools", "ty")  # that build, run or read a submission
# What shows and runs a class, and has no part in what is seen of a submission.
_NO_PART = ("classroom", "verbs", "bundles", "widgets", "page", "side_bar", "course", "__pycache__")


def submission(paths: Iterable[Path]) -> tuple[str, int]:
    """Return the digest of all that was handed in, and when its newest file was written, in s.

    What is not received, such as .git and paths that are too long, does not count; after as much as a submission may
    hold, nothing does.

    Raises:
        OSError: if something of it cannot be read.
    """
    digest, newest, left = hashlib.sha256(), 0.0, MOST_BYTES
    for path in paths:
        for name, file in files(path):
            state = file.lstat()
            newest = max(newest, state.st_mtime)
            target = os.fsencode(file.readlink()) if file.is_symlink() else b""
            about = (os.fsencode(name), state.st_mode & 0o170100, target, state.st_size)
            digest.update(repr(about).encode())  # so that it is plain where each of them ends
            if stat.S_ISREG(state.st_mode):
                with opened(file) as data:
                    while left > 0 and (chunk := data.read(1 << 20)):
                        digest.update(chunk)
                        left -= len(chunk)
    return digest.hexdigest(), int(newest)


def files(path: Path) -> Iterator[tuple[str, Path]]:
    """Yield each file that is received of a submission, with its name in it; an archive's own name is not part of it."""
    if not path.is_dir():
        yield path.suffix, path
        return
    for parent, folders, names in os.walk(path):
        above = Path(parent).relative_to(path).parts
        folders[:] = sorted(
            name for name in folders if not TOOLS_NAMES.fullmatch(name) and not is_too_long((*above, name))
        )
        links = [name for name in folders if Path(parent, name).is_symlink()]
        for name in sorted(name for name in [*names, *links] if not is_too_long((*above, name))):
            file = Path(parent, name)
            yield str(file.relative_to(path)), file


def assignment(folder: Path | None) -> str:
    """Return the digest of what was asked for; None for the course's own."""
    return _of_text(_text(folder, "assignment.yaml"))


def rubric(folder: Path | None, path: Path | None) -> str:
    """Return the digest of what the points are given for, and of what gives them."""
    text = path.read_text(encoding="utf-8") if path else _text(folder, "rubric.yaml")
    return _of_text(text + grader())


def _text(folder: Path | None, name: str) -> str:
    if folder:
        return (folder / name).read_text(encoding="utf-8")
    own = resources.files("ros2lab.assignments").joinpath(f"{assignments.WEEK_2}/{name}")
    return own.read_text(encoding="utf-8")


@cache
def grader() -> str:
    """Return the digest of the program that grades, of the Python that runs it, and of the tools that it asks."""
    about = [__version__, sys.version_info[:2], *(_release(tool) for tool in _TOOLS)]
    digest = hashlib.sha256(repr(about).encode())
    for module in (ros2lab, portable_ros2):
        package = Path(next(iter(module.__path__)))
        for path in sorted(package.rglob("*")):
            place = path.relative_to(package)
            if path.suffix in (".py", ".yaml", ".xml") and not {*place.parts} & {*_NO_PART}:
                digest.update(f"{package.name}/{place}\0".encode() + path.read_bytes())
    return digest.hexdigest()


def _release(tool: str) -> str:
    try:
        return importlib.metadata.version(tool)
    except importlib.metadata.PackageNotFoundError:  # of an installed ROS
        return ""


def _of_text(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
