"""`ros2 pkg executables`."""

from __future__ import annotations

import argparse

from portable_ros2 import ament_index, completion
from portable_ros2.verb import Verb


class ExecutablesVerb(Verb):
    """Output a list of package specific executables."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        package = parser.add_argument("package_name", nargs="?", help="The package name")
        package.completer = completion.packages  # type: ignore[attr-defined]
        parser.add_argument("--full-path", action="store_true", help="Show full path of each executable")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        named = args.package_name
        for package in completion.packages() if named is None else [named]:
            try:
                paths = ament_index.executables(package)
            except ament_index.PackageNotFoundError:
                return f"Package '{package}' not found"
            for path in paths:
                print(path if args.full_path else f"{package} {path.name}")
        return None
