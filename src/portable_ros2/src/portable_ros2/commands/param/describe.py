"""`ros2 param describe`."""

from __future__ import annotations

import argparse
from typing import Any

from portable_ros2.commands.param import _parameters
from portable_ros2.verb import Verb


class DescribeVerb(Verb):
    """Show descriptive information about declared parameters."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _parameters.add_arguments(parser)
        names = parser.add_argument("parameter_names", nargs="+", help="Names of the parameters")
        names.completer = _parameters.complete_parameter  # type: ignore[attr-defined]

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        from rcl_interfaces.srv import DescribeParameters

        with _parameters.Target(args) as node:
            answer = node.ask("describe", DescribeParameters.Request(names=args.parameter_names))
        for descriptor in answer.descriptors:
            _show(descriptor)


def _show(descriptor: Any) -> None:
    print(f"Parameter name: {descriptor.name}")
    print(f"  Type: {_parameters.TYPE_NAMES[descriptor.type]}")
    if descriptor.description:
        print(f"  Description: {descriptor.description}")
    print("  Constraints:")
    if descriptor.read_only:
        print("    Read only: true")
    for limits in [*descriptor.floating_point_range, *descriptor.integer_range][:1]:
        print(f"    Min value: {limits.from_value}")
        print(f"    Max value: {limits.to_value}")
        if limits.step:
            print(f"    Step: {limits.step}")
    if descriptor.additional_constraints:
        print(f"    Additional constraints: {descriptor.additional_constraints}")
