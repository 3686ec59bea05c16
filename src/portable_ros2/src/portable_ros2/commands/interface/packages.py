"""`ros2 interface packages`."""

from __future__ import annotations

import argparse

from portable_ros2 import interfaces
from portable_ros2.commands.interface._kinds import add_kind_arguments, chosen_kinds
from portable_ros2.verb import Verb


class PackagesVerb(Verb):
    """Output a list of packages that provide interfaces."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        add_kind_arguments(parser, "Only list packages that generate {}s")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        kinds = chosen_kinds(args)
        for package in interfaces.packages():
            if interfaces.of_package(package, kinds):
                print(package)
