"""`ros2 interface list`."""

from __future__ import annotations

import argparse

from portable_ros2 import interfaces
from portable_ros2.commands.interface._kinds import add_kind_arguments, chosen_kinds
from portable_ros2.verb import Verb


class ListVerb(Verb):
    """List all interface types available."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        add_kind_arguments(parser, "Print out only the {} types")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        packages = interfaces.packages()
        for kind in chosen_kinds(args):
            print(f"{interfaces.KINDS[kind]}:")
            for package in packages:
                for name in sorted(interfaces.of_package(package, (kind,))):
                    print(f"    {package}/{name}")
