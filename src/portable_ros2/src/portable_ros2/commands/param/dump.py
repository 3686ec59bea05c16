"""`ros2 param dump`."""

from __future__ import annotations

import argparse
from typing import Any

from portable_ros2.commands.param import _parameters
from portable_ros2.verb import Verb

SEPARATOR = "."


class DumpVerb(Verb):
    """Show all of the parameters of a node in a YAML file format."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _parameters.add_arguments(parser)

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        import yaml
        from rcl_interfaces.srv import GetParameters
        from rclpy.parameter import parameter_value_to_python

        with _parameters.Target(args) as node:
            (names,) = _parameters.names_of(node, [node.target])
            if isinstance(names, RuntimeError):
                return str(names)
            values = node.ask("get", GetParameters.Request(names=names)).values
        parameters = nested(dict(zip(names, map(parameter_value_to_python, values), strict=False)))
        print(yaml.dump({node.target: {"ros__parameters": parameters}}, default_flow_style=False))
        return None


def nested(parameters: dict[str, Any]) -> dict[str, Any]:
    """Return parameters by the parts of their names, as files have them: `a.b` becomes b in a.

    Where a name is a part of another's (`a` and `a.b`), the longer one keeps its dots.
    """
    tree: dict[str, Any] = {}
    for name, value in parameters.items():
        branch, rest = tree, name
        while SEPARATOR in rest:
            part, _, after = rest.partition(SEPARATOR)
            if not isinstance(branch.setdefault(part, {}), dict):
                break
            branch, rest = branch[part], after
        branch[rest] = value
    return tree
