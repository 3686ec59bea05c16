"""`ros2 param get`."""

from __future__ import annotations

import argparse

from portable_ros2.commands.param import _parameters
from portable_ros2.verb import Verb

LABELS = (
    "Parameter not set.",
    "Boolean value is:",
    "Integer value is:",
    "Double value is:",
    "String value is:",
    "Byte values are:",
    "Boolean values are:",
    "Integer values are:",
    "Double values are:",
    "String values are:",
)


class GetVerb(Verb):
    """Get parameter."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _parameters.add_arguments(parser, parameter="parameter_name")
        parser.add_argument("--hide-type", action="store_true", help="Hide the type information")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        from rcl_interfaces.srv import GetParameters
        from rclpy.parameter import parameter_value_to_python

        with _parameters.Target(args) as node:
            values = node.ask("get", GetParameters.Request(names=[args.parameter_name])).values
        if not values:
            return "Parameter not set"
        kind = values[0].type
        if kind >= len(LABELS):
            return f"Unknown parameter type '{kind}'"
        value = parameter_value_to_python(values[0])
        if args.hide_type:
            print(value)
        else:
            print(LABELS[kind] if value is None else f"{LABELS[kind]} {value}")
        return None
