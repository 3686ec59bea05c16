"""`ros2 topic list`."""

from __future__ import annotations

import argparse

from portable_ros2 import graph
from portable_ros2.commands.topic import _topics
from portable_ros2.verb import Verb


class ListVerb(Verb):
    """Output a list of available topics."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        parser.add_argument(
            "-t", "--show-types", action="store_true", help="Additionally show the topic type"
        )
        parser.add_argument(
            "-c", "--count-topics", action="store_true", help="Only display the number of topics discovered"
        )
        parser.add_argument(
            "--include-hidden-topics", action="store_true", help="Consider hidden topics as well"
        )
        parser.add_argument("-v", "--verbose", action="store_true", help="List full details about each topic")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        with graph.GraphNode(args) as node:
            topics = _topics.names_and_types(node, args.include_hidden_topics)
            publishers = {name: node.count_publishers(name) for name, _ in topics if args.verbose}
            subscribers = {name: node.count_subscribers(name) for name, _ in topics if args.verbose}
        if args.count_topics:
            print(len(topics))
        elif args.verbose and topics:
            print(_details("Published", "publisher", topics, publishers))
            print(_details("Subscribed", "subscriber", topics, subscribers))
        else:
            for name, types in topics:
                print(f"{name} [{', '.join(types)}]" if args.show_types else name)


def _details(title: str, role: str, topics: _topics.NamesAndTypes, counts: dict[str, int]) -> str:
    lines = [f"{title} topics:"]
    for name, types in topics:
        if count := counts[name]:
            lines.append(f" * {name} [{', '.join(types)}] {count} {role}{'s' * (count > 1)}")
    return "\n".join(lines) + "\n"
