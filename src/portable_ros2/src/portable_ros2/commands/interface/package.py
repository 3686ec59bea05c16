"""`ros2 interface package`."""

from __future__ import annotations

import argparse

from portable_ros2 import interfaces
from portable_ros2.commands.interface._kinds import add_kind_arguments, chosen_kinds
from portable_ros2.verb import Verb


class PackageVerb(Verb):
    """Output a list of available interface types within one package."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        add_kind_arguments(parser, "Print out only the {} types")
        name = parser.add_argument("package_name", help="Name of the ROS package (e.g. 'std_msgs')")
        name.completer = lambda **_: interfaces.packages()  # type: ignore[attr-defined]

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        try:
            names = interfaces.of_package(args.package_name, chosen_kinds(args))
        except LookupError as error:
            return str(error)
        for name in names:
            print(f"{args.package_name}/{name}")
        return None
