"""`ros2 param load`."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from portable_ros2.commands.param import _parameters
from portable_ros2.verb import Verb


class LoadVerb(Verb):
    """Load parameter file for a node."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _parameters.add_arguments(parser)
        parser.add_argument("parameter_file", help="Parameter file")
        parser.add_argument(
            "--no-use-wildcard",
            action="store_true",
            help="Do not load parameters in the '/**' namespace into the node",
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        with _parameters.Target(args) as node:
            parameters = _read(args.parameter_file, not args.no_use_wildcard)
            results = node.set(parameters)
        for parameter, result in zip(parameters, results, strict=True):
            reason = f": {result.reason}" if result.reason else ""
            word = "successful" if result.successful else "failed"
            print(
                f"Set parameter {parameter.name} {word}{reason}",
                file=sys.stdout if result.successful else sys.stderr,
            )


def _read(path: str, use_wildcard: bool) -> list[Any]:
    """Return the parameters of all of the nodes in a file, as Jazzy does.

    Raises:
        RuntimeError: if it cannot be read or is no parameter file.
    """
    import yaml
    from rclpy.parameter import parameter_dict_from_yaml_file

    try:
        return list(parameter_dict_from_yaml_file(path, use_wildcard).values())
    except OSError as error:
        raise RuntimeError(f"Cannot read '{path}': {error.strerror}") from error
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = f" at line {mark.line + 1}" if mark else ""
        problem = getattr(error, "problem", None) or str(error)
        raise RuntimeError(f"'{path}' is not valid YAML{place}: {problem}") from error
    except (AttributeError, TypeError, ValueError) as error:  # a list, a number, nothing at all
        raise RuntimeError(f"'{path}' is not a ROS parameter file") from error
