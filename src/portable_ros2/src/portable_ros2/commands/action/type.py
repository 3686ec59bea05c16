"""`ros2 action type`."""

from __future__ import annotations

import argparse

from portable_ros2 import graph
from portable_ros2.commands.action import _actions
from portable_ros2.verb import Verb


class TypeVerb(Verb):
    """Print an action's type."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _actions.add_action_argument(parser, " to get type")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> int:
        with graph.GraphNode(args) as node:
            types = dict(_actions.names_and_types(node)).get(args.action_name, [])
        for name in types:
            print(name)
        return int(not types)
