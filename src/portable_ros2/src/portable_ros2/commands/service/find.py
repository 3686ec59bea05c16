"""`ros2 service find`."""

from __future__ import annotations

import argparse
from typing import Any

from portable_ros2 import graph
from portable_ros2.commands.service import _services
from portable_ros2.verb import Verb


class FindVerb(Verb):
    """Output a list of available services of a given type."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        kind = parser.add_argument(
            "service_type",
            help="Name of the ROS service type to filter for (e.g. 'rcl_interfaces/srv/ListParameters')",
        )
        kind.completer = _complete  # type: ignore[attr-defined]
        parser.add_argument(
            "-c",
            "--count-services",
            action="store_true",
            help="Only display the number of services discovered",
        )
        _services.add_hidden_argument(parser)

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        with graph.GraphNode(args) as node:
            services = _services.names_and_types(node, args.include_hidden_services)
        found = [name for name, types in services if args.service_type in types]
        if args.count_services:
            print(len(found))
            return
        for name in found:
            print(name)


def _complete(**_: Any) -> list[str]:
    return _services.service_types()
