"""Where a figure is measured: an empty folder and a ROS domain in which nobody else speaks."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from ros2lab import environment


class Place(NamedTuple):
    """An empty student's folder, and the environment of a lab in it."""

    folder: Path
    environ: dict[str, str]


@contextlib.contextmanager
def own_place() -> Iterator[Place]:
    """Make a place, and remove it with everything in it."""
    domain = os.environ.get("ROS_DOMAIN_ID") or str(environment.own_domain(f"benchmark {os.getpid()}"))
    with tempfile.TemporaryDirectory(prefix="ros2lab-figures-", ignore_cleanup_errors=True) as name:
        environ = environment.lab_environment({**os.environ, "ROS_DOMAIN_ID": domain})
        yield Place(Path(name), {**environ, "ROS2LAB_WORK": name})
