"""`ros2 service info`."""

from __future__ import annotations

import argparse

from portable_ros2 import graph
from portable_ros2.commands.service import _services
from portable_ros2.verb import Verb


class InfoVerb(Verb):
    """Print information about a service."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        graph.add_arguments(parser)
        _services.add_service_argument(parser, "get info (e.g. '/add_two_ints')")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        name: str = args.service_name
        with graph.GraphNode(args) as node:
            services = dict(_services.names_and_types(node, args.include_hidden_services))
            if name not in services:
                return f"Unknown service '{name}'"
            types = services[name]
            print(f"Type: {types[0] if len(types) == 1 else types}")
            print(f"Clients count: {node.count_clients(name)}")
            print(f"Services count: {node.count_services(name)}")
        return None
