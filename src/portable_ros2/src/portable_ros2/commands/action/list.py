"""`ros2 action list`."""

from __future__ import annotations

import argparse

from portable_ros2 import graph
from portable_ros2.commands.action import _actions
from portable_ros2.verb import Verb


class ListVerb(Verb):
    """Output a list of action names."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument(
            "-t", "--show-types", action="store_true", help="Additionally show the action type"
        )
        parser.add_argument(
            "-c",
            "--count-actions",
            action="store_true",
            help="Only display the number of actions discovered",
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        with graph.GraphNode(args) as node:
            actions = _actions.names_and_types(node)
        if args.count_actions:
            print(len(actions))
            return
        for name, types in actions:
            print(f"{name} [{', '.join(types)}]" if args.show_types else name)
