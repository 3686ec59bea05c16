"""Arguments of bubblewrap: what a box is shown, and where."""

from __future__ import annotations

import importlib.util
import platform
import shutil
import sys
from collections.abc import Iterable
from pathlib import Path

from ros2lab.grading.receiving.clean_copy import is_too_long
from ros2lab.grading.sandbox.box import SandboxMissing

OWN = "/tmp/own"  # noqa: S108 -- where a box's own writable folders lie

# Hidden from each box that does not ask for it: the grader itself, and the folder with the course's solution,
# which is the grader's own if it is installed, and otherwise the whole checkout.
PACKAGE = Path(__file__).parents[2]
HIDDEN = sorted({PACKAGE, (PACKAGE / "course/robot_project_ws").resolve().parent})

_EMPTY = PACKAGE / "py.typed"
_UNUSED = (
    ("rosidl_generator_py", "generate_py_impl.py"),
    ("numpy", "_core/_add_newdocs.py"),
    ("numpy", "_core/_add_newdocs_scalars.py"),
)

_SYSTEM = ("usr", "bin", "sbin", "lib", "lib32", "lib64", "libx32")
_TAKEN = frozenset((*_SYSTEM, "etc", "proc", "dev", "sys", "tmp", "run", "opt", "submission"))  # below /
# What an installation of Python puts into its folder; anything else there belongs to a user.
_PYTHONS = ("bin", "etc", "include", "lib", "lib64", "pyvenv.cfg", "share")
_SETTINGS = ("alternatives", "ld.so.cache", "ld.so.conf", "ld.so.conf.d")


def program() -> str:
    """Return the path of bubblewrap.

    Raises:
        SandboxMissing: if it is not installed, or this is not an x86-64 machine.
    """
    if platform.machine() != "x86_64":
        raise SandboxMissing(f"The sandbox needs an x86-64 machine and this is {platform.machine()}.")
    path = shutil.which("bwrap")
    if path is None:
        raise SandboxMissing("bubblewrap is not installed: run `sudo apt install bubblewrap`.")
    return path


def system() -> list[str]:
    """Return the arguments that show the system's programs, read-only."""
    words = ["--dir", "/etc"]
    for folder in (Path("/", name) for name in _SYSTEM):
        if folder.is_symlink():
            words += ["--symlink", str(folder.readlink()), str(folder)]
        elif folder.is_dir():
            words += ["--ro-bind", str(folder), str(folder)]
    for name in _SETTINGS:
        words += ["--ro-bind-try", f"/etc/{name}", f"/etc/{name}"]
    return words


def shown(paths: Iterable[Path]) -> list[Path]:
    """Return what boxes see besides the system: this Python, an installed ROS 2 and `paths`, sorted."""
    base = Path(sys.base_prefix)
    python = [Path(sys.prefix), base, base.resolve()]
    link = Path(sys.executable)
    while link.is_symlink():
        link = link.parent / link.readlink()
        if link.parent.parent.resolve() == base.resolve():
            python.append(link.parent.parent)  # another path to the same Python
    parts = {folder / name for folder in python for name in _PYTHONS}
    ros = Path("/opt/ros")
    paths = [path.absolute() for path in paths]
    for path in paths:
        if not path.exists():
            raise ValueError(f"{path} is to be shown to the boxes and is not there: take it out, or make it.")
    return sorted({*filter(Path.exists, parts), *paths, *([ros] if ros.is_dir() else [])})


def emptied() -> list[str]:
    """Return the arguments that show as empty some modules that are slow to import and that no node needs.

    ROS messages import the message generator, if it is there, which takes a seventh of a node's start. numpy,
    which they import too, adds documentation to each of its functions.
    """
    words = []
    for package, name in _UNUSED:
        spec = importlib.util.find_spec(package)
        path = Path(spec.origin).parent / name if spec and spec.origin else None
        if path and path.is_file():
            words += ["--ro-bind", str(_EMPTY), str(path)]
    return words


def bound(paths: Iterable[Path | str], *, is_hidden: bool = False) -> list[str]:
    """Return the arguments that show `paths` read-only in their place; those in /usr only if `is_hidden`."""
    words = []
    for path in map(Path, paths):
        if is_hidden or not path.is_relative_to("/usr"):
            words += [*_parents(path), "--ro-bind", str(path), str(path)]
    return words


def _parents(path: Path) -> list[str]:
    """Return the arguments that make the parents of `path`, which else only the owner of a file can read."""
    return [word for parent in reversed(path.parents[:-1]) for word in ("--dir", str(parent))]


def writable(folders: Iterable[str], shown: Iterable[Path]) -> tuple[list[str], list[str]]:
    """Return where in a box's /tmp `folders` are made, and the arguments that link their own paths to them.

    Folders of the system, and those around or inside `shown`, stay as they are. Impossible paths are
    left out.
    """
    made, words, links = list[str](), list[str](), set[Path]()
    for folder in map(Path, folders):
        if folder == Path("/") or is_too_long(folder.parts):
            continue
        free = [
            place
            for place in (*reversed(folder.parents), folder)
            if not any(path.is_relative_to(place) for path in shown)
        ]
        is_taken = folder.parts[1] in _TAKEN or any(folder.is_relative_to(path) for path in shown)
        if free and not is_taken:
            made.append(f"{OWN}{folder}")
            if free[0] not in links:
                words += ["--symlink", f"{OWN}{free[0]}", str(free[0])]
                links.add(free[0])
    return made, words


def hiding(paths: Iterable[Path], inside: Iterable[Path]) -> list[str]:
    """Return the arguments that show `paths` and `inside`, but nothing else of what is `HIDDEN`."""
    inside = {*inside}
    hidden = [folder for folder in HIDDEN if folder not in inside]
    words = list[str]()
    for path in sorted({*paths, *inside, *hidden}):
        if path in hidden:
            words += [*_parents(path), "--tmpfs", str(path)]
        else:
            words += bound([path], is_hidden=any(map(path.is_relative_to, hidden)))
    return [*words, *(word for folder in reversed(hidden) for word in ("--remount-ro", str(folder)))]
