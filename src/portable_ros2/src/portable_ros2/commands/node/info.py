"""`ros2 node info`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from typing import Any

from portable_ros2 import graph
from portable_ros2.commands.node import _nodes
from portable_ros2.verb import Verb

NamesAndTypes = list[tuple[str, list[str]]]


class InfoVerb(Verb):
    """Output information about a node."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        name = parser.add_argument("node_name", help="Node name to request information")
        name.completer = _nodes.complete  # type: ignore[attr-defined]
        parser.add_argument(
            "--include-hidden",
            action="store_true",
            help="Display hidden topics, services, and actions as well",
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        name: str = args.node_name
        with graph.GraphNode(args) as node:
            known = [known.full_name for known in _nodes.present(node, args.include_hidden)]
            count = known.count(name)
            if not count:
                return f"Unable to find node '{name}'"
            if count > 1:
                print(
                    f'There are {count} nodes in the graph with the exact name "{name}". '
                    "You are seeing information about only one of them.",
                    file=sys.stderr,
                )
            try:
                sections = list(_sections(node, _nodes.parse(name), args.include_hidden))
            except _gone():
                return f"Unable to find node '{name}'"  # it has ended meanwhile
        print(name)
        for title, names_and_types in sections:
            print(f"  {title}:")
            # An empty section is an empty line.
            print("\n".join(f"    {topic}: {', '.join(types)}" for topic, types in names_and_types))
        return None


def _sections(node: Any, name: _nodes.NodeName, include_hidden: bool) -> Iterator[tuple[str, NamesAndTypes]]:
    from rclpy import action

    def of_actions(function: Callable[..., NamesAndTypes]) -> Callable[..., NamesAndTypes]:
        return lambda *names: function(node.node, *names)

    functions: dict[str, Callable[..., NamesAndTypes]] = {
        "Subscribers": node.get_subscriber_names_and_types_by_node,
        "Publishers": node.get_publisher_names_and_types_by_node,
        "Service Servers": node.get_service_names_and_types_by_node,
        "Service Clients": node.get_client_names_and_types_by_node,
        "Action Servers": of_actions(action.get_action_server_names_and_types_by_node),
        "Action Clients": of_actions(action.get_action_client_names_and_types_by_node),
    }
    for title, function in functions.items():
        found = function(name.name, name.namespace)
        yield title, [entry for entry in found if include_hidden or not _nodes.is_hidden(entry[0])]


def _gone() -> type[Exception]:
    from rclpy._rclpy_pybind11 import NodeNameNonExistentError

    gone: type[Exception] = NodeNameNonExistentError
    return gone
