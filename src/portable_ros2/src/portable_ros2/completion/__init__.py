"""What the completion of packages and executables offers; the scripts beside it are for the shells to source."""

from __future__ import annotations

import argparse
from typing import Any

from portable_ros2 import ament_index


def packages(**_: Any) -> list[str]:
    """Return the names of the packages, sorted."""
    return sorted(ament_index.resources(ament_index.PACKAGES))


def executables(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Return the names of the executables of the package on the command line."""
    try:
        return [path.name for path in ament_index.executables(parsed_args.package_name)]
    except ament_index.PackageNotFoundError:
        return []
