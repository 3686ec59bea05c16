"""`ros2 topic info`."""

from __future__ import annotations

import argparse

from portable_ros2 import graph
from portable_ros2.commands.topic import _topics
from portable_ros2.verb import Verb


class InfoVerb(Verb):
    """Print information about a topic."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        _topics.add_topic_argument(parser, "get info")
        parser.add_argument(
            "-v",
            "--verbose",
            action="store_true",
            help="Print the node, type hash, GUID and quality of service of each publisher and subscriber too",
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        topic = args.topic_name
        with graph.GraphNode(args) as node:
            types = dict(_topics.names_and_types(node, include_hidden=True)).get(topic)
            if types is None:
                return f"Unknown topic '{topic}'"
            parts = [f"Type: {types[0] if len(types) == 1 else types}"]
            parts.append(f"Publisher count: {node.count_publishers(topic)}")
            if args.verbose:
                parts += map(str, node.get_publishers_info_by_topic(topic))
            parts.append(f"Subscription count: {node.count_subscribers(topic)}")
            if args.verbose:
                parts += map(str, node.get_subscriptions_info_by_topic(topic))
        for part in parts:
            print(part, end="\n\n" if args.verbose else "\n")
        return None
