"""`ros2 pkg prefix`."""

from __future__ import annotations

import argparse

from portable_ros2 import ament_index, completion
from portable_ros2.verb import Verb


class PrefixVerb(Verb):
    """Output the prefix path of a package."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        package = parser.add_argument("package_name", help="The package name")
        package.completer = completion.packages  # type: ignore[attr-defined]
        parser.add_argument("--share", action="store_true", help="Show share directory for the package")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        find = ament_index.share_folder if args.share else ament_index.package_prefix
        try:
            print(find(args.package_name))
        except ament_index.PackageNotFoundError:
            return "Package not found"
        return None
