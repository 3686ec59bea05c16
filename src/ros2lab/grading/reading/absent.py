"""What a submission names that is neither in it nor installed here."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path, PurePosixPath

from ros2lab.diagnose.code.imports import ROS_1
from ros2lab.diagnose.launching.launch_file import read_launch_file
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import PythonSource, read_text
from ros2lab.diagnose.sources.spelling import is_near_miss
from ros2lab.grading.reading.graded_package import Package
from ros2lab.grading.reading.launch_files import launch_files, shares_named

MARKERS = "share/ament_index/resource_index/packages"  # holds a file named for each installed package
MOST_PLACES = 20
_HOMES = (("home",), ("root",), ("mnt",), ("media",))  # below which people make folders
_PATH = re.compile(r"/[\w .+-]+(?:/[\w .+-]+)+/?")
_PROGRAM_NAME = re.compile(r"[A-Za-z0-9_][\w.-]{0,99}")


def absent_packages(
    packages: Iterable[Package], own: Collection[str], prefixes: Sequence[str]
) -> dict[str, list[str]]:
    """Return the packages that launch files name and that are neither in the submission nor installed here.

    Each has the executables that launch files start from it. A name that is close to that of a package in the
    submission is a misspelling and left out.
    """
    found: dict[str, list[str]] = {}

    def is_there(package: str) -> bool:
        is_own = any(package == name or is_near_miss(package, name) for name in own)
        return is_own or is_installed(package, prefixes)

    for path in launch_files(packages):
        for node in read_launch_file(path, path.name).nodes:
            words = (node.package, node.executable)
            if not all(isinstance(word, str) and _PROGRAM_NAME.fullmatch(word) for word in words):
                continue
            if not is_there(node.package) and node.executable not in found.get(node.package, ()):
                found.setdefault(node.package, []).append(node.executable)
        for name in shares_named(read_text(path)):
            if not is_there(name):
                found.setdefault(name, [])
    return found


def is_installed(package: str, prefixes: Sequence[str]) -> bool:
    """Return whether an ament package is installed here."""
    return any(prefix and Path(prefix, MARKERS, package).exists() for prefix in prefixes)


def absent_modules(
    root: Path, sources: Iterable[PythonSource], own: Collection[str], unbuilt: Collection[str]
) -> set[str]:
    """Return the modules that sources import and that are neither in the submission nor installed here.

    Modules of packages that cannot be built here, such as a student's own messages, are included. Misspelt
    names and modules of ROS 1 are left out.

    Args:
        root: the folder that holds all that was received.
        sources: the sources that are graded.
        own: the names of all packages in the submission.
        unbuilt: those of them that cannot be built here.
    """
    tops = {
        found.target.partition(".")[0]
        for source in sources
        for found in source.imports
        if not found.is_guarded
    }
    there = {path.stem for path in root.rglob("*") if path.is_dir() or path.suffix == ".py"}
    known = ({*own} | there) - {*unbuilt} | sys.stdlib_module_names | {*ROS_1}
    return {
        top
        for top in tops - known
        if top.isidentifier() and not interfaces.is_installed(top)
        if top in unbuilt or not (interfaces.meant(top) or any(is_near_miss(top, name) for name in known))
    }


def named_places(sources: Iterable[PythonSource]) -> list[str]:
    """Return the folders that code names by an absolute path: those of its files, and those below a home."""
    found = set[str]()
    for source in sources:
        constants = (node.value for node in source.nodes if isinstance(node, ast.Constant))
        for path in {
            PurePosixPath(value) for value in constants if isinstance(value, str) and _PATH.fullmatch(value)
        }:
            is_file = bool(path.suffix)
            if ".." not in path.parts and (is_file or path.parts[1:2] in _HOMES):
                found.add(str(path.parent if is_file else path))
    return sorted(found)[:MOST_PLACES]
