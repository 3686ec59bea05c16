"""Packages and their executables, as ament lays them out on disk.

Each prefix on `AMENT_PREFIX_PATH` holds `share/ament_index/resource_index/packages/<package>`; executables
lie in `lib/<package>/`. Source: https://github.com/ament/ament_cmake/blob/master/ament_cmake_core/doc/resource_index.md
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

PACKAGES = "packages"


class PackageNotFoundError(RuntimeError):
    """No prefix holds the package; the text says so."""


def prefixes() -> list[Path]:
    """Return the existing folders that are searched, first one first.

    The pip wheels install themselves as an index below `sys.prefix` and set no variable, so that comes last.
    """
    parts = [part for part in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if part]
    if (Path(sys.prefix) / "share" / "ament_index").is_dir():
        parts.append(sys.prefix)
    return [Path(part) for part in dict.fromkeys(parts) if Path(part).is_dir()]


def resources(kind: str) -> dict[str, Path]:
    """Return the prefix of each resource of a kind, by name; of two, the one on the earlier prefix."""
    found: dict[str, Path] = {}
    for prefix in prefixes():
        folder = prefix / "share" / "ament_index" / "resource_index" / kind
        if folder.is_dir():
            for path in folder.iterdir():
                if not path.name.startswith(".") and path.is_file():
                    found.setdefault(path.name, prefix)
    return found


def resource(kind: str, name: str) -> str | None:
    """Return the content of a resource, None if there is none."""
    for prefix in prefixes():
        path = prefix / "share" / "ament_index" / "resource_index" / kind / name
        if path.is_file():
            return path.read_text(encoding="utf-8", errors="replace")
    return None


def package_prefix(package: str) -> Path:
    """Return the prefix in which a package is installed.

    Raises:
        PackageNotFoundError: if it is in none.
    """
    for prefix in prefixes() if package and os.sep not in package else ():
        if (prefix / "share" / "ament_index" / "resource_index" / PACKAGES / package).is_file():
            return prefix
    raise PackageNotFoundError(package)


def share_folder(package: str) -> Path:
    """Return `share/<package>` of a package.

    Raises:
        PackageNotFoundError: if the package is not installed.
    """
    return package_prefix(package) / "share" / package


def executables(package: str) -> list[Path]:
    """Return the executables of a package in the order of their paths; none of hidden folders.

    Raises:
        PackageNotFoundError: if the package is not installed.
    """
    folder = package_prefix(package) / "lib" / package
    return sorted(
        path
        for path in folder.rglob("*")
        if path.is_file()
        and os.access(path, os.X_OK)
        and not any(part.startswith(".") for part in path.relative_to(folder).parts[:-1])
    )
