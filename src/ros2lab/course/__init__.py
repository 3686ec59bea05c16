"""What the course ships, and the student's folder into which it is copied.

`notebooks` and `robot_project_ws` beside this file are links to the repository's folders; in a built wheel
they are the files themselves.
"""

from __future__ import annotations

import contextlib
import glob
import importlib
import itertools
import json
import os
import re
import shutil
import stat
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, BinaryIO

from ros2lab.scratch import scratch_folder

if TYPE_CHECKING:
    from rclpy.node import Node

    from ros2lab.workspace import Workspace

MARKER = ".ros2lab"
MARKER_TEXT = "ros2lab knows the student's folder by this file. Please leave it here.\n"
PROJECT = "robot_project_ws"
LESSONS = "notebooks"  # the folder of the lessons in the student's folder
# Whatever else lies among the notebooks, such as a copy that an editor made, is not the course's.
LESSON_NAME = re.compile(r"\d\d_[a-z0-9_]+\.ipynb")

_HERE = Path(__file__).parent
# What the student's folder begins with. It may lie inside a folder with a configuration, such as this
# repository, and is a world of its own: each tool that looks in the folders above for its configuration finds
# one here, which asks for nothing. What a student has in a package or a workspace is nearer, and wins.
_FIRST_FILES = {
    MARKER: MARKER_TEXT,
    # No repository either. Black, mypy, ruff and others take it for the top of a project, too.
    ".git": "gitdir: (none; to make a repository of this whole folder, remove the file .git in it first)\n",
    ".pytest.ini": "# pytest looks no further up for its configuration.\n[pytest]\n",
    # Where pytest would begin without the file above, so that tests are called what they are called elsewhere.
    ".colcon/defaults.yaml": "# Options of colcon.\ntest:\n  pytest-args: [--rootdir=.]\n",
    ".ruff.toml": "# ruff looks no further up for its configuration.\n",
    # isort reads it, too, and looks further up if nothing is set.
    ".editorconfig": "root = true\n\n[*.py]\nindent_style = space\nindent_size = 4\n",
}
_LONGEST_NAME = 230  # bytes, so that a longer one can stand beside it for a while
_SYSTEMS = ("dev", "proc")  # below / is what has no other file beside it
_PRODUCTS = ("build", "install", "log", "__pycache__", "*.egg-info", ".*")


@cache
def project() -> tuple[str, dict[str, str]]:
    """Return the package of the project, and the classes of its nodes, which lesson 8 imports, by module."""
    from ros2lab import assignments  # noqa: PLC0415 -- a kernel's start does not wait for it

    assignment = assignments.load()
    names = sorted(assignment.parts)
    return assignment.package, {name: "".join(map(str.title, name.split("_"))) for name in names}


def notebooks() -> list[Path]:
    """Return the course's notebooks, in the order of their numbers."""
    return sorted(path for path in (_HERE / "notebooks").iterdir() if LESSON_NAME.fullmatch(path.name))


def reference_workspace() -> Path:
    """Return the reference workspace. It is to be read: build in a copy."""
    return _HERE / "robot_project_ws"


def reference_nodes() -> list[type[Node]]:
    """Return the classes of the reference's three nodes, without a build: the command subscriber comes first.

    What this kernel imports later as `robot_controller` is not this one, but what it has sourced.
    """
    name, classes = project()
    package = str(reference_workspace() / "src" / name)
    writes_bytecode = not sys.dont_write_bytecode
    others = _loaded(name)
    sys.path.insert(0, package)
    sys.dont_write_bytecode = True
    try:
        modules = [importlib.import_module(f"{name}.{module}") for module in classes]
    finally:
        sys.dont_write_bytecode = not writes_bytecode
        sys.path.remove(package)
        _loaded(name)
        sys.modules.update(others)
    return [getattr(module, node) for module, node in zip(modules, classes.values(), strict=True)]


def work_folder(environ: Mapping[str, str] = os.environ, cwd: Path | None = None) -> Path:
    """Return the student's folder, which need not exist yet.

    It is `$ROS2LAB_WORK`, else the nearest folder at or above `cwd` that holds the marker, else `./work`; and where
    a notebook was opened among the course's own, it is `work` beside them, so that nothing is written there.

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
    lessons = (_HERE / "notebooks").resolve()
    return (lessons.parent if start.resolve().is_relative_to(lessons) else start) / "work"


def open_work_folder(folder: Path) -> None:
    """Make the student's folder, or add what is missing of what it begins with; what is there stays.

    Raises:
        OSError: if it cannot be made or written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in _FIRST_FILES.items():
        if not os.path.lexists(folder / name):
            write_whole(folder / name, text.encode())


def copy_reference(folder: Path, name: str = PROJECT, *, has_tests: bool = True) -> Path:
    """Copy the reference workspace into `folder` as `name`, unless that is there already; return its path.

    Links are resolved, so that the copy stands on its own.

    Args:
        folder: where the copy lies.
        name: what it is called.
        has_tests: whether the package's own tests, which take a minute, are copied, too.

    Raises:
        OSError: if a file cannot be written.
    """
    target = folder / name
    if target.exists():
        return target
    folder.mkdir(parents=True, exist_ok=True)
    left_out = _PRODUCTS if has_tests else (*_PRODUCTS, "test")
    # Copied beside it and then renamed: an interrupted copy must not pass for a whole one.
    with scratch_folder(folder) as scratch:
        whole = scratch / target.name
        shutil.copytree(reference_workspace(), whole, ignore=shutil.ignore_patterns(*left_out))
        whole.rename(target)
    return target


def own_workspace() -> Workspace:
    """Return the student's `~/robot_project_ws` if its three nodes are there; else the reference, without its tests.

    Raises:
        OSError: if a file cannot be written.
    """
    from ros2lab.workspace import Workspace  # noqa: PLC0415 -- the lab's start does not wait for it

    own = work_folder() / PROJECT
    package, classes = project()
    missing = [
        f"{module}.{name}"
        for module, name in classes.items()
        if not _defines(own / "src", package, module, name)
    ]
    if not missing:
        sys.stdout.write(f"{shown_path(own)}: your own\n")
        return Workspace(own)
    reference = copy_reference(work_folder(), "reference_ws", has_tests=False)
    because = f"yours lacks {', '.join(missing)}" if own.exists() else "lesson 7 builds your own"
    sys.stdout.write(f"{shown_path(reference)}: the course's reference ({because})\n")
    return Workspace(reference)


def _loaded(package: str) -> dict[str, ModuleType]:
    """Take what is imported of a package out of `sys.modules`, and return it."""
    names = [name for name in sys.modules if name == package or name.startswith(f"{package}.")]
    return {name: sys.modules.pop(name) for name in names}


def _defines(sources: Path, package: str, module: str, name: str) -> bool:
    """Return whether a package below a folder has a module that defines a class."""
    files = sources.glob(f"**/{package}/{module}.py")
    return any(re.search(rf"^class {name}\b", file.read_text("utf-8", "replace"), re.M) for file in files)


def student_path(path: str | Path) -> Path:
    """Return a path as the lab's terminals understand it: `~`, and what is relative, is in the student's folder."""
    text = str(path)
    return work_folder() / (text.removeprefix("~").lstrip("/") if text.startswith("~") else text)


def shown_path(path: Path) -> str:
    """Return a path as the lab's terminals show it."""
    home = work_folder()
    return "~" if path == home else f"~/{path.relative_to(home)}" if path.is_relative_to(home) else str(path)


def earlier_folder() -> Path:
    """Return where what a lesson replaces is kept."""
    return work_folder() / "earlier"


def start_over(*folders: str) -> None:
    """Let a lesson begin: folders of the student's that it makes anew are moved to `~/earlier`, never removed.

    Args:
        folders: as the lab's terminals write them, such as `~/ros2_ws`.

    Raises:
        OSError: if one cannot be moved.
    """
    for name in folders:
        folder = student_path(name)
        if os.path.lexists(folder):
            keep_earlier(folder, is_moved=True)
        sys.stdout.write(
            f"{shown_path(folder)} is yours to make; an earlier one would be in {shown_path(earlier_folder())}\n"
        )


def keep_earlier(path: Path, *, is_moved: bool = False) -> Path:
    """Copy (or move) a file or folder to `~/earlier` under a name that is free there; return the new path.

    Raises:
        OSError: if that cannot be done.
    """
    earlier_folder().mkdir(parents=True, exist_ok=True)
    names = (earlier_folder() / f"{path.name}-{number}" for number in itertools.count(1))
    target = next(name for name in names if not os.path.lexists(name))
    if is_moved:
        rename_kept(path, target)
    else:
        with path.open("rb") as before, whole_file(target) as file:
            shutil.copyfileobj(before, file)
        shutil.copystat(path, target)
    return target


def read_json(path: Path) -> Any:
    """Return what a file of JSON holds; None where there is none, or none that can be read."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None


def write_whole(path: Path, data: bytes) -> None:
    """Write a file as `whole_file` does.

    Raises:
        OSError: if it cannot be written.
    """
    with whole_file(path) as file:
        file.write(data)


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """Give a file to write, which has its name only once it is whole.

    Until then the name stands for what it stood for before: after an error or Ctrl-C, on a full disk, without power.
    The rights of an earlier file stay, and what a writer that was killed has left beside it is removed.
    A device or an open file, such as /dev/stdout, is written to as it is.

    Raises:
        OSError: if it cannot be written.
    """
    if path.exists() and path.absolute().parts[1] in _SYSTEMS:
        with os.fdopen(os.open(path, os.O_WRONLY | os.O_APPEND), "wb") as file:
            yield file
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    name = path.name if len(os.fsencode(path.name)) < _LONGEST_NAME else "part"
    _remove_parts(path.parent, name)
    part = path.with_name(f".{name}.{os.getpid()}.part")
    try:
        part.unlink(missing_ok=True)  # in a shared folder, a link that somebody else has put there
        with part.open("xb") as file:
            yield file
            file.flush()
            with contextlib.suppress(FileNotFoundError):
                os.fchmod(file.fileno(), stat.S_IMODE(path.stat().st_mode))
            os.fsync(file.fileno())
        rename_kept(part, path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def rename_kept(old: Path, new: Path) -> None:
    """Give a file or folder another name, instead of a file that has it, so that the name is kept without power.

    Raises:
        OSError: if that cannot be done.
    """
    old.replace(new)
    for folder in {old.parent, new.parent}:
        with contextlib.suppress(OSError):  # a file system that cannot, or a folder that is gone
            handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
            try:
                os.fsync(handle)
            finally:
                os.close(handle)


def _remove_parts(folder: Path, name: str) -> None:
    """Remove what writers of a file have left that were killed."""
    for path in folder.glob(f".{glob.escape(name)}.*.part"):
        number = path.name.removesuffix(".part").rpartition(".")[2]
        if number.isdigit() and not Path("/proc", number).exists():
            with contextlib.suppress(OSError):
                path.unlink()
