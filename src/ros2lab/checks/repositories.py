"""What lesson 10 expects of a git repository, and of what is packed: the sources, and nothing that was built."""

from __future__ import annotations

import shutil
from collections.abc import Iterable
from pathlib import Path, PurePath

from ros2lab.checks import CheckError
from ros2lab.clean_build import BUILT, IGNORE_FILE, digests, handed_in, listed
from ros2lab.git import git


def expect_nothing_built(paths: Iterable[PurePath], expected: str, *hints: str) -> None:
    """Check that colcon has made none of these files, by their paths in the workspace."""
    built = sorted(products(paths))
    misplaced = [path for path in built if path.parts[0] not in BUILT and set(BUILT).intersection(path.parts)]
    if misplaced:
        raise CheckError(
            expected,
            f"{len(misplaced)} files, the first {misplaced[0]}: colcon was run in the wrong folder",
            "colcon builds where you stand: remove what it has made there, and build where src/ is.",
            *hints,
        )
    if built:
        raise CheckError(expected, f"{len(built)} files, the first {built[0]}", *hints)


def in_last_commit(folder: Path) -> list[str]:
    """Return the files of the last commit."""
    return [name for name in git(folder, "ls-tree", "-r", "-z", "--name-only", "HEAD").split("\0") if name]


def expect_repository(folder: Path) -> None:
    """Check that a folder is a git repository with a commit of the sources, and of nothing that is built."""
    if shutil.which("git") is None:
        raise CheckError(
            "the command git", "it is not installed", "Debian and Ubuntu: `sudo apt install git`."
        )
    top = git(folder, "rev-parse", "--show-toplevel").strip()
    if not top or Path(top).resolve() != folder.resolve():
        raise CheckError(
            "a git repository in the workspace",
            f"the one in {top}" if top else "none",
            "make one with `git init` in the workspace's folder.",
        )
    if not git(folder, "rev-parse", "--verify", "--quiet", "HEAD"):
        raise CheckError("a commit", "none yet", "type `git add .`, then `git commit -m` with a message.")
    expect_nothing_built(
        map(PurePath, in_last_commit(folder)),
        "nothing that was built is in git",
        "take them out of git, and leave them in the folder: `git rm -r --cached build install log`, then commit.",
        "name the three folders in .gitignore before you add.",
    )
    too_much = ignored_sources(folder)
    if too_much:
        name, rule = too_much[0]
        raise CheckError(
            "git takes everything that you have written",
            f"it ignores {name}, because of {rule}",
            "take that line out of .gitignore, or let it name only what is built; then add and commit.",
        )
    missing = [name for name in digests(folder) if name not in in_last_commit(folder)]
    if missing:
        raise CheckError(
            "the sources are in the last commit",
            f"without {listed(missing)}",
            "type `git add src`, then `git commit -m` with a message.",
        )
    if not digests(folder):
        raise CheckError("a package below src/", "no file there", "is it the workspace of your project?")
    left_open = [name for name in BUILT if name not in ignored(folder)]
    if left_open:
        raise CheckError(
            ".gitignore names build/, install/ and log/",
            f"git would take {', '.join(f'{name}/' for name in left_open)}",
            "one name a line, in a file .gitignore beside src/.",
        )


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
