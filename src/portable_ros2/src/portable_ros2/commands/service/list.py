"""`ros2 service list`."""

from __future__ import annotations

import argparse

from portable_ros2 import graph
from portable_ros2.commands.service import _services
from portable_ros2.verb import Verb


class ListVerb(Verb):
    """Output a list of available services."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        parser.add_argument(
            "-t", "--show-types", action="store_true", help="Additionally show the service type"
        )
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
        if args.count_services:
            print(len(services))
            return
        for name, types in services:
            print(f"{name} [{', '.join(types)}]" if args.show_types else name)
