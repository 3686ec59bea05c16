"""A workspace as a git repository: what git takes of it, and what a tool has made."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path, PurePath

from ros2lab.clean_build import BUILT, IGNORE_FILE, handed_in
from ros2lab.git import git

_NOBODY_ELSES = ("-c", "core.excludesFile=/dev/null")  # what this user ignores everywhere, others do not


def ignored(folder: Path) -> list[str]:
    """Return which of the folders that colcon makes git would not take."""
    shown = git(folder, *_NOBODY_ELSES, "check-ignore", *(f"{name}/x" for name in BUILT))
    return [line.removesuffix("/x") for line in shown.splitlines()]


def ignored_sources(folder: Path) -> list[tuple[str, str]]:
    """Return the files that somebody has written and git does not take, each with the line that is to blame."""
    names = [path.relative_to(folder).as_posix() for path in handed_in(folder)]
    shown = git(folder, *_NOBODY_ELSES, "check-ignore", "--verbose", "--", *names)
    pairs = [line.rpartition("\t") for line in shown.splitlines()]
    return [(name, rule) for rule, _, name in pairs]


def products(paths: Iterable[PurePath]) -> list[PurePath]:
    """Return those files of a workspace that colcon, Python or git has made.

    Args:
        paths: relative to the workspace's folder. Below it, a folder such as `build` is colcon's if it holds
            the file COLCON_IGNORE, which colcon puts into each that it makes.
    """
    files = list(paths)
    made = {PurePath(name) for name in BUILT}
    made |= {file.parent for file in files if file.name == IGNORE_FILE and file.parent.name in BUILT}
    return [
        file
        for file in files
        if made.intersection(file.parents) or {"__pycache__", ".git"}.intersection(file.parts)
    ]
