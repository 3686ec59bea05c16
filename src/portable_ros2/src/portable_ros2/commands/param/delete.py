"""`ros2 param delete`."""

from __future__ import annotations

import argparse
import sys

from portable_ros2.commands.param import _parameters
from portable_ros2.verb import Verb


class DeleteVerb(Verb):
    """Delete parameter."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _parameters.add_arguments(parser, parameter="parameter_name")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        from rcl_interfaces.msg import Parameter

        with _parameters.Target(args) as node:
            (result,) = node.set([Parameter(name=args.parameter_name)])  # a value that is not set
        reason = f": {result.reason}" if result.reason else ""
        if result.successful:
            print(f"Deleted parameter successfully{reason}")
        else:
            print(f"Deleting parameter failed{reason}", file=sys.stderr)
