"""`ros2 topic find`."""

from __future__ import annotations

import argparse

from portable_ros2 import graph
from portable_ros2.commands.topic import _topics
from portable_ros2.verb import Verb


class FindVerb(Verb):
    """Output a list of available topics of a given type."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        _topics.add_type_argument(parser, "topic_type", "Name of the ROS topic type to filter for")
        parser.add_argument(
            "-c", "--count-topics", action="store_true", help="Only display the number of topics discovered"
        )
        parser.add_argument(
            "--include-hidden-topics", action="store_true", help="Consider hidden topics as well"
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        with graph.GraphNode(args) as node:
            topics = _topics.names_and_types(node, args.include_hidden_topics)
        found = [name for name, types in topics if args.topic_type in types]
        if args.count_topics:
            print(len(found))
        else:
            for name in found:
                print(name)
