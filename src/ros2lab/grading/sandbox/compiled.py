"""Compile the modules that programs in a box import, because nothing in a box can save a compiled module.

An installer need not compile what it installs: Python saves a compiled module when it first imports one.
Modules that only boxes import, such as colcon's, would be compiled again for each submission, which takes as
long as all else.
"""

from __future__ import annotations

import compileall
import importlib.metadata
import importlib.util
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from ros2lab.grading.sandbox.bubblewrap import PACKAGE

# The distributions whose programs boxes start, or whose modules nodes and tests import; a setup.py that is
# asked for its commands imports docutils. The modules of an installed ROS 2 were compiled by Debian's
# packages.
STARTED = (
    "colcon-common-extensions",
    "docutils",
    "numpy",
    "portable_ros2",
    "pytest",
    "ros-jazzy-common-interfaces",
    "ros-rclpy",
    "setuptools",
)
_NAME = re.compile(r"[\w.-]+")


def compile_modules(sources: Iterable[Path] | None = None) -> int:
    """Compile the files that are not compiled or have changed since; skip those that cannot be saved.

    Args:
        sources: the files; None takes those that boxes import.

    Returns:
        How many of the files are compiled now.
    """
    return sum(
        compileall.compile_file(path, quiet=2) for path in (imported() if sources is None else sources)
    )


def imported() -> Iterator[Path]:
    """Yield the sources that boxes import: of `STARTED` and of what these require, if it is installed."""
    yield from PACKAGE.rglob("*.py")
    waiting, known = [*STARTED], set[str]()
    while waiting:
        name = waiting.pop()
        if name in known:
            continue
        known.add(name)
        try:
            distribution = importlib.metadata.distribution(name)
        except importlib.metadata.PackageNotFoundError:
            continue
        waiting += (
            match[0]
            for required in distribution.requires or ()
            if "extra ==" not in required and (match := _NAME.match(required))
        )
        for file in distribution.files or ():
            if file.suffix == ".py" and "tests" not in file.parts:
                yield Path(str(file.locate()))
    for name in (
        "launch",
        "launch_ros",
        "portable_ros2",
    ):  # in a checkout, their distributions list no files
        spec = importlib.util.find_spec(name)
        for folder in (spec and spec.submodule_search_locations) or ():
            yield from Path(folder).rglob("*.py")
