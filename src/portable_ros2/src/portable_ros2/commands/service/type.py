"""`ros2 service type`."""

from __future__ import annotations

import argparse

from portable_ros2 import graph
from portable_ros2.commands.service import _services
from portable_ros2.verb import Verb


class TypeVerb(Verb):
    """Output a service's type."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _services.add_service_argument(parser, "get type (e.g. '/talker/list_parameters')")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> int:
        with graph.GraphNode(args) as node:
            services = dict(_services.names_and_types(node, args.include_hidden_services))
        if args.service_name not in services:
            return 1
        for name in services[args.service_name]:
            print(name)
        return 0
