"""`ros2 param list`."""

from __future__ import annotations

import argparse
import re
import sys
from typing import Any

from portable_ros2 import graph
from portable_ros2.commands.node import _nodes
from portable_ros2.commands.param import _parameters
from portable_ros2.verb import Verb


class ListVerb(Verb):
    """Output a list of available parameters."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        node_name = parser.add_argument("node_name", nargs="?", help="Name of the ROS node")
        node_name.completer = _nodes.complete  # type: ignore[attr-defined]
        parser.add_argument(
            "--filter",
            nargs=1,
            help="Only parameters matching the regex expression will be showed. Supports `re` regex syntax.",
        )
        _parameters.add_hidden_argument(parser)
        parser.add_argument(
            "--param-prefixes",
            nargs="+",
            default=[],
            help="Only list parameters with the provided prefixes",
        )
        parser.add_argument(
            "--param-type", action="store_true", help="Print parameter types with parameter names"
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        try:
            pattern = re.compile(args.filter[0] if args.filter else "")
        except re.error as error:
            return f"The filter '{args.filter[0]}' is no regular expression: {error}"
        with graph.GraphNode(args) as node:
            targets = [name.full_name for name in sorted(_nodes.present(node, args.include_hidden_nodes))]
            if args.node_name:
                target = _nodes.absolute(args.node_name)
                if target not in targets:
                    return "Node not found"
                targets = [target]
            targets = list(dict.fromkeys(targets))
            answers = _parameters.names_of(node, targets, args.param_prefixes)
            for target, answer in zip(targets, answers, strict=True):
                if isinstance(answer, RuntimeError):
                    print(answer, file=sys.stderr)
                    continue
                names = [name for name in answer if pattern.match(name)]
                if names and not args.node_name:
                    print(f"{target}:")
                types = _types(node, target, names) if args.param_type else {}
                for name in names:
                    print(f"  {name} (type: {types[name]})" if name in types else f"  {name}")
        return None


def _types(node: Any, target: str, names: list[str]) -> dict[str, str]:
    from rcl_interfaces.srv import DescribeParameters

    answer = _parameters.ask(node, target, "describe", DescribeParameters.Request(names=names))
    return {found.name: _parameters.TYPE_NAMES[found.type] for found in answer.descriptors}
