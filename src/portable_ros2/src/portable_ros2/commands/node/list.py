"""`ros2 node list`."""

from __future__ import annotations

import argparse
import sys

from portable_ros2 import graph
from portable_ros2.commands.node import _nodes
from portable_ros2.verb import Verb


class ListVerb(Verb):
    """Output a list of available nodes."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        parser.add_argument("-a", "--all", action="store_true", help="Display all nodes even hidden ones")
        parser.add_argument(
            "-c", "--count-nodes", action="store_true", help="Only display the number of nodes discovered"
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        with graph.GraphNode(args) as node:
            names = sorted(name.full_name for name in _nodes.present(node, args.all))
        if args.count_nodes:
            print(len(names))
            return
        if len(set(names)) < len(names):
            print(
                "WARNING: Be aware that there are nodes in the graph that share an exact name,"
                " which can have unintended side effects.",
                file=sys.stderr,
            )
        for name in names:
            print(name)
