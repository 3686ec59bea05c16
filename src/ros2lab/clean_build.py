"""A build from nothing, in a folder apart: what an earlier build has left cannot spoil or save it."""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import shutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from ros2lab import course, environment
from ros2lab.scratch import PREFIX, scratch_folder
from ros2lab.workspace import BuildResult, Workspace

BUILT = ("build", "install", "log")  # what colcon makes where it is run
IGNORE_FILE = "COLCON_IGNORE"
SHORT_DIGEST = 12  # letters; enough to tell two versions of a file apart


@dataclass(frozen=True)
class CleanBuild:
    """What came of it.

    Attributes:
        workspace: the copy, for as long as the folder apart is there.
        result: of `colcon build`.
        files: how many files were built, below `src`.
    """

    workspace: Workspace
    result: BuildResult
    files: int


@contextlib.contextmanager
def built_from_nothing(root: Path, package: str | None = None) -> Iterator[CleanBuild]:
    """Copy what somebody has written in a workspace to an empty folder, and build it there.

    The folder lies in the student's and is removed in the end. Meanwhile this process and what it starts find no
    workspace that was sourced before.

    Args:
        root: the workspace's folder.
        package: only this one is built; None builds all.

    Raises:
        WorkspaceError: if there is no workspace, the package is not in it, or colcon is missing.
        OSError: if a file cannot be read or written.
    """
    with folder_apart() as apart, _nothing_sourced():
        copy = apart / root.name
        copy.mkdir()
        for path in handed_in(root):
            target = copy / path.relative_to(root)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(path, target)
        workspace = Workspace(copy)
        yield CleanBuild(
            workspace, workspace.build(package, show=False), sum(1 for _ in handed_in(copy / "src"))
        )


@contextlib.contextmanager
def folder_apart() -> Iterator[Path]:
    """Make an empty folder in the student's folder; it is removed in the end.

    Raises:
        OSError: if it cannot be made.
    """
    place = course.work_folder() / "hand_in"
    place.mkdir(parents=True, exist_ok=True)
    with scratch_folder(place) as folder:
        yield folder


def in_place(text: str) -> str:
    """Return a text in which what lies in a folder apart is called what it is called in the student's folder."""
    place = re.escape(str(course.work_folder() / "hand_in"))
    return re.sub(rf"{place}/\.{PREFIX}\w+", "~", text)


def handed_in(root: Path) -> Iterator[Path]:
    """Yield the files below a folder that somebody has written, following links to folders once."""
    seen: set[str] = set()
    for folder, subfolders, names in os.walk(root, followlinks=True):
        real = os.path.realpath(folder)
        if real in seen:
            subfolders.clear()
            continue
        seen.add(real)
        is_root = Path(folder) == root
        subfolders[:] = sorted(
            name
            for name in subfolders
            if not name.startswith((".", "__pycache__"))
            and not name.endswith(".egg-info")
            and not (name in BUILT and (is_root or Path(folder, name, IGNORE_FILE).is_file()))
        )
        for name in sorted(names):
            is_hidden = name.startswith(".") and name != ".gitignore"
            if not is_hidden and not name.endswith((".pyc", ".zip")) and Path(folder, name).is_file():
                yield Path(folder, name)


def digests(root: Path, below: str = "src") -> dict[str, str]:
    """Return a short digest of each file that can change what is built or run, by its path in the workspace.

    Args:
        root: the workspace's folder.
        below: the folder in it that is looked at; "" looks at all, READMEs and other texts included.
    """
    return {
        path.relative_to(root).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()[:SHORT_DIGEST]
        for path in handed_in(root / below)
        if not below or not _is_text(path.name)
    }


def differing(now: Mapping[str, str], then: Mapping[str, str]) -> list[str]:
    """Return the files that have changed, appeared or gone from one time to another, sorted."""
    return sorted(name for name in {*now, *then} if now.get(name) != then.get(name))


def listed(names: Iterable[str], most: int = 3) -> str:
    """Return names as they stand in a sentence, the first few of them."""
    all_names = [*names]
    more = len(all_names) - most
    return ", ".join(all_names[:most]) + (f" and {more} more" if more > 0 else "")


def is_readme(name: str) -> bool:
    """Return whether a file of this name is a README."""
    return re.fullmatch(r"readme(\.\w+)?", name, re.IGNORECASE) is not None


def _is_text(name: str) -> bool:
    return is_readme(name) or name.endswith((".md", ".rst")) or name in (".gitignore", "LICENSE")


@contextlib.contextmanager
def _nothing_sourced() -> Iterator[None]:
    before = dict(os.environ)
    kept = environment.without_workspaces(before)
    changed = {name for name, value in before.items() if kept.get(name) != value}
    for name in changed:
        os.environ.pop(name)
    os.environ.update({name: kept[name] for name in changed & kept.keys()})
    try:
        yield
    finally:
        os.environ.update({name: before[name] for name in changed})
