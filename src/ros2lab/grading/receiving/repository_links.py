"""Links from a folder inside a repository to other places in the same repository."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path

from ros2lab.git import git
from ros2lab.grading.receiving.clean_copy import Member
from ros2lab.grading.receiving.notes import Kind
from ros2lab.grading.receiving.unpacking import in_folder

_LINK = "120000"  # git's mode of a symbolic link
# The repository may be anybody's: its configuration must start no program.
_CAREFULLY = ("-c", "core.fsmonitor=false")


def linked_members(
    folder: Path, note: Callable[[Kind, str], None]
) -> Iterator[tuple[Member, tuple[str, ...]]]:
    """Yield what a folder's links lead to, outside the folder but inside the repository around it.

    Only links that are in the repository's index in the same form are followed, none that was put into the
    checkout otherwise, such as one of a submission beside a solution, and none into another workspace.

    Args:
        folder: the folder, which is only read.
        note: called for what was taken from elsewhere, and what was left out.

    Yields:
        Each member, and the parts of the path in `folder` below which it belongs.
    """
    here = Path(os.path.realpath(folder))
    # Not what git says: a repository's own settings can name any folder as the one that it holds.
    top = next((path for path in (here, *here.parents) if os.path.lexists(path / ".git")), here)
    if top == here:
        return
    for name, target in _tracked_links(folder, top):
        end = Path(os.path.realpath(folder / name))
        is_elsewhere = end.is_relative_to(top) and not end.is_relative_to(here)
        if not is_elsewhere or ".git" in end.relative_to(top).parts or not end.is_dir():
            continue
        if _is_in_another_workspace(end, here):
            note("of another workspace", f"{name} -> {target}")
            continue
        note("from elsewhere", f"{name} -> {target}")
        for member in in_folder(end, note):
            yield member, Path(name).parts


def _is_in_another_workspace(end: Path, here: Path) -> bool:
    """Return whether a folder lies in a workspace that is not the one handed in, or holds one: it may be somebody else's."""
    common = Path(os.path.commonpath((end, here)))
    around = [path for path in (end, *end.parents) if path != common and path.is_relative_to(common)]
    return any(map(_is_workspace, (*around, *(path for path in end.iterdir() if path.is_dir()))))


def _is_workspace(folder: Path) -> bool:
    """Return whether a folder has a src with a package."""
    return any((folder / "src").glob("*/package.xml"))


def _tracked_links(folder: Path, top: Path) -> Iterator[tuple[str, str]]:
    """Yield the links below a folder that match the repository's index, with their targets."""
    listed = git(folder, *_CAREFULLY, f"--work-tree={top}", "ls-files", "--stage", "-z")
    for entry in filter(None, listed.split("\0")):
        attributes, _, name = entry.partition("\t")
        mode, digest, _ = attributes.split()
        path = folder / name
        if mode == _LINK and path.is_symlink():
            target = str(path.readlink())
            if digest == _digest(os.fsencode(target)):
                yield name, target


def _digest(content: bytes) -> str:
    """Return git's object id of some content; https://git-scm.com/book/en/v2/Git-Internals-Git-Objects."""
    return hashlib.sha1(b"blob %d\0%s" % (len(content), content), usedforsecurity=False).hexdigest()
