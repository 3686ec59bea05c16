"""`ros2 action info`."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any

from portable_ros2 import graph
from portable_ros2.commands.action import _actions
from portable_ros2.commands.node import _nodes
from portable_ros2.verb import Verb


class InfoVerb(Verb):
    """Print information about an action."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _actions.add_action_argument(parser, " to get info")
        parser.add_argument(
            "-t", "--show-types", action="store_true", help="Additionally show the action type"
        )
        parser.add_argument(
            "-c",
            "--count",
            action="store_true",
            help="Only display the number of action clients and action servers",
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        from rclpy import action

        with graph.GraphNode(args) as node:
            name = _absolute(node, args.action_name)
            ends = {
                "clients": _nodes_with(node, action.get_action_client_names_and_types_by_node, name),
                "servers": _nodes_with(node, action.get_action_server_names_and_types_by_node, name),
            }
        print(f"Action: {args.action_name}")
        for end, nodes in ends.items():
            print(f"Action {end}: {len(nodes)}")
            for full_name, types in [] if args.count else nodes:
                print(f"    {full_name} [{', '.join(types)}]" if args.show_types else f"    {full_name}")


def _absolute(node: Any, name: str) -> str:
    """Return the whole name of an action.

    Raises:
        RuntimeError: if it is none.
    """
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.expand_topic_name import expand_topic_name
    from rclpy.validate_full_topic_name import validate_full_topic_name

    try:
        absolute: str = expand_topic_name(name, node.get_name(), node.get_namespace())
        validate_full_topic_name(absolute)
    except (ValueError, InvalidTopicNameException) as error:
        raise RuntimeError(str(error)) from error
    return absolute


def _nodes_with(
    node: Any, names_and_types_by_node: Callable[..., _actions.NamesAndTypes], action_name: str
) -> list[tuple[str, list[str]]]:
    """Return the nodes that have one end of an action, with its types."""
    from rclpy._rclpy_pybind11 import NodeNameNonExistentError

    found = []
    for known in _nodes.present(node, include_hidden=True):
        try:
            actions = dict(names_and_types_by_node(node.node, known.name, known.namespace))
        except NodeNameNonExistentError:
            continue  # it has ended meanwhile
        if action_name in actions:
            found.append((known.full_name, actions[action_name]))
    return found
