"""`ros2 param set`."""

from __future__ import annotations

import argparse
import sys

from portable_ros2.commands.param import _parameters
from portable_ros2.verb import Verb


class SetVerb(Verb):
    """Set parameter."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _parameters.add_arguments(parser, parameter="parameter_name")
        parser.add_argument("value", help="Value of the parameter")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        from rcl_interfaces.msg import Parameter

        value = _parameters.value_from_text(args.value)
        with _parameters.Target(args) as node:
            (result,) = node.set([Parameter(name=args.parameter_name, value=value)])
        reason = f": {result.reason}" if result.reason else ""
        if result.successful:
            print(f"Set parameter successful{reason}")
        else:
            print(f"Setting parameter failed{reason}", file=sys.stderr)
