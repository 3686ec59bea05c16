"""`ros2 topic type`."""

from __future__ import annotations

import argparse

from portable_ros2 import graph
from portable_ros2.commands.topic import _topics
from portable_ros2.verb import Verb


class TypeVerb(Verb):
    """Print a topic's type."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        _topics.add_topic_argument(parser, "get type")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> int:
        with graph.GraphNode(args) as node:
            topics = dict(_topics.names_and_types(node, args.include_hidden_topics))
        for type_name in topics.get(args.topic_name, []):
            print(type_name)
        return 0 if args.topic_name in topics else 1
