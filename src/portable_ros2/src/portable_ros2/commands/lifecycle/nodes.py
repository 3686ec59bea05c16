"""`ros2 lifecycle nodes`."""

from __future__ import annotations

import argparse

from portable_ros2 import graph
from portable_ros2.commands.lifecycle import _lifecycle
from portable_ros2.verb import Verb


class NodesVerb(Verb):
    """Output a list of nodes with lifecycle."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        parser.add_argument("-a", "--all", action="store_true", help="Display all nodes even hidden ones")
        parser.add_argument(
            "-c", "--count-nodes", action="store_true", help="Only display the number of nodes discovered"
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        with graph.GraphNode(args) as node:
            names = _lifecycle.nodes_of(node, args.all)
        if args.count_nodes:
            print(len(names))
        elif names:
            print(*names, sep="\n")
