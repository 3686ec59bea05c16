"""Compile the modules that programs in a box import, which those cannot write there themselves.

An installer need not compile what it installs: Python writes a compiled module when it first imports one. What only
boxes import, such as colcon, would then be compiled for each submission anew, which takes as long as all else.
"""

from __future__ import annotations

import compileall
import importlib.metadata
import importlib.util
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from ros2lab.grading.bubblewrap import PACKAGE

# Whose programs are started in boxes, and whose modules nodes and tests import; docutils is imported by a setup.py
# that is asked for its commands. What an installed ROS 2 brings was compiled by Debian's packages.
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
    """Compile what has not been compiled as it is now; what cannot be written is left as it is.

    Args:
        sources: files; None takes what boxes import.

    Returns:
        How many files are compiled now.
    """
    return sum(
        compileall.compile_file(path, quiet=2) for path in (imported() if sources is None else sources)
    )


def imported() -> Iterator[Path]:
    """Yield the sources of what boxes import: of `STARTED` and what these require, as far as it is installed."""
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
    ):  # whose distribution lists no files where it is a checkout
        spec = importlib.util.find_spec(name)
        for folder in (spec and spec.submodule_search_locations) or ():
            yield from Path(folder).rglob("*.py")
