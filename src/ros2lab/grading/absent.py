"""What a hand-in names that it does not hold, and that is not installed here either."""

from __future__ import annotations

import re
import sys
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path

from ros2lab.diagnose import interfaces
from ros2lab.diagnose.imports import ROS_1
from ros2lab.diagnose.launch_file import read_launch_file
from ros2lab.diagnose.python_source import read_text
from ros2lab.diagnose.spelling import is_near_miss
from ros2lab.grading.files import launch_files
from ros2lab.grading.graded_package import Package

MARKERS = "share/ament_index/resource_index/packages"  # where the names of installed packages lie
# What a launch file may look up the share folder of a package with, in Python, XML or YAML.
_SHARE_OF = re.compile(
    r"(?:get_package_share\w*|FindPackageShare)\(\s*(?:package(?:_name)?=)?['\"](\w+)|find-pkg-share +(\w+)"
)
_PROGRAM_NAME = re.compile(r"[A-Za-z0-9_][\w.-]{0,99}")


def absent_packages(
    packages: Iterable[Package], own: Collection[str], prefixes: Sequence[str]
) -> dict[str, list[str]]:
    """Return what launch files start or name of packages that were not handed in and are not installed here.

    A name that looks like one of those that were handed in is a misspelt one, and no other package.
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
        for names in _SHARE_OF.findall(read_text(path)):
            if not is_there(name := "".join(names)):
                found.setdefault(name, [])
    return found


def is_installed(package: str, prefixes: Sequence[str]) -> bool:
    """Return whether an ament package is installed here."""
    return any(prefix and Path(prefix, MARKERS, package).exists() for prefix in prefixes)


def absent_modules(package: Package, own: Collection[str], unbuilt: Collection[str]) -> set[str]:
    """Return the modules that a package imports and that were not handed in and are not installed here.

    A name that looks like that of one which is there is a misspelt one; one of ROS 1 is in no ROS 2. Those of packages
    that cannot be built here, such as messages of one's own, are among them.
    """
    tops = {
        found.target.partition(".")[0]
        for source in package.own_sources
        for found in source.imports
        if not found.is_guarded
    }
    folders = {path.name for path in package.folder.rglob("*") if path.is_dir()} - {*unbuilt}
    known = {*own, *folders, *sys.stdlib_module_names, *ROS_1}
    return {
        top
        for top in tops - known
        if top.isidentifier() and not interfaces.is_installed(top)
        if top in unbuilt or not (interfaces.meant(top) or any(is_near_miss(top, name) for name in known))
    }
