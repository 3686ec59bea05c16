"""What the course ships, and the student's folder into which it is copied.

`notebooks` and `robot_project_ws` beside this file are links to the repository's folders; in a built wheel
they are the files themselves.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ros2lab.workspace import Workspace

MARKER = ".ros2lab"

_HERE = Path(__file__).parent
_MARKER_TEXT = "ros2lab knows the student's folder by this file. Please leave it here.\n"
_PRODUCTS = ("build", "install", "log", "__pycache__", "*.egg-info", ".*")


def notebooks() -> list[Path]:
    """Return the course's notebooks, in the order of their numbers."""
    return sorted((_HERE / "notebooks").glob("[!.]*.ipynb"))


def reference_workspace() -> Path:
    """Return the reference workspace. It is to be read: build in a copy."""
    return _HERE / "robot_project_ws"


def work_folder(environ: Mapping[str, str] = os.environ, cwd: Path | None = None) -> Path:
    """Return the student's folder, which need not exist yet.

    It is `$ROS2LAB_WORK`, else the nearest folder at or above `cwd` that holds the marker, else `./work`.

    Args:
        environ: where `ROS2LAB_WORK` is looked up.
        cwd: the folder to start from; None is the current one.
    """
    start = Path.cwd() if cwd is None else cwd.absolute()
    chosen = environ.get("ROS2LAB_WORK")
    if chosen:
        return start / Path(chosen).expanduser()
    for folder in (start, *start.parents):
        if (folder / MARKER).is_file():
            return folder
    return start / "work"


def open_work_folder(folder: Path) -> None:
    """Make the student's folder, or do nothing where it is made already.

    Raises:
        OSError: if it cannot be made or written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / MARKER).is_file():
        (folder / MARKER).write_text(_MARKER_TEXT, encoding="utf-8")


def copy_notebooks(folder: Path) -> tuple[int, int]:
    """Copy the course's notebooks, and the files that they show, into the student's folder.

    What is there already is the student's and is left alone.

    Args:
        folder: the student's folder; the notebooks go into its `notebooks`.

    Returns:
        How many notebooks were copied, and how many were there already.

    Raises:
        OSError: if a file cannot be written.
    """
    ours = set(notebooks())
    copied = set(_copy_missing(_HERE / "notebooks", folder / "notebooks"))
    return len(ours & copied), len(ours - copied)


def copy_reference(folder: Path) -> Path:
    """Copy the reference workspace into `folder`, unless it is there already; return the copy's path.

    Links are resolved, so that the copy stands on its own.

    Raises:
        OSError: if a file cannot be written.
    """
    target = folder / "robot_project_ws"
    if target.exists():
        return target
    folder.mkdir(parents=True, exist_ok=True)
    # Copied beside it and then renamed: an interrupted copy must not pass for a whole one.
    with tempfile.TemporaryDirectory(prefix=".robot_project_ws-", dir=folder) as scratch:
        whole = Path(scratch, target.name)
        shutil.copytree(reference_workspace(), whole, ignore=shutil.ignore_patterns(*_PRODUCTS))
        whole.rename(target)
    return target


def own_workspace() -> Workspace:
    """Return the student's `robot_project_ws`: a copy of the reference, unless it is there already.

    Raises:
        OSError: if a file cannot be written.
    """
    from ros2lab.workspace import Workspace  # noqa: PLC0415 -- the lab's start does not wait for it

    return Workspace(copy_reference(work_folder()))


def _copy_missing(source: Path, target: Path) -> Iterable[Path]:
    """Copy the files below `source` that `target` lacks; yield those that were copied."""
    hidden = shutil.ignore_patterns(*_PRODUCTS)
    for folder, subfolders, names in os.walk(source):
        ignored = hidden(folder, [*subfolders, *names])
        subfolders[:] = set(subfolders) - ignored
        for name in set(names) - ignored:
            path = Path(folder, name)
            destination = target / path.relative_to(source)
            if not os.path.lexists(destination):
                _copy_whole(path, destination)
                yield path


def _copy_whole(source: Path, target: Path) -> None:
    """Copy a file so that it is either whole or not there, also after Ctrl-C."""
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(f".{target.name}.part")
    shutil.copyfile(source, part)
    part.rename(target)
