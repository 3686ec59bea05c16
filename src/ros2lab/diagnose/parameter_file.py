"""A parameter file as ROS reads it: nodes, `ros__parameters`, and plain values."""

from __future__ import annotations

from typing import Any, ClassVar

import yaml

from ros2lab.diagnose import bounded_yaml

_LARGEST_INT = 2**63  # rcl keeps 64 bits


class ParameterFileError(ValueError):
    """A text is no parameter file; its text says why.

    Attributes:
        line: where, from 1 on; None if it is not known.
    """

    def __init__(self, reason: str, line: int | None) -> None:
        super().__init__(reason)
        self.line = line


def read_parameter_file(text: str) -> Any:
    """Return what a parameter file holds: for ROS a date is a text, and there are no aliases.

    Raises:
        ParameterFileError: if it is no YAML, or holds what ROS does not read.
    """
    try:
        return bounded_yaml.load(text, _Loader, has_aliases=False)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        reason = getattr(error, "problem", None) or "it cannot be read"
        raise ParameterFileError(reason, mark.line + 1 if mark else None) from None
    except (ValueError, LookupError, AttributeError, TypeError):
        # What PyYAML raises for a value that its tag does not allow.
        raise ParameterFileError("a value cannot be read", None) from None


class _Loader(yaml.SafeLoader):
    yaml_implicit_resolvers: ClassVar = {
        first: [(tag, pattern) for tag, pattern in resolvers if not tag.endswith(":timestamp")]
        for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }

    def construct_yaml_int(self, node: Any) -> int:
        value: int = super().construct_yaml_int(node)
        if not -_LARGEST_INT <= value < _LARGEST_INT:
            raise yaml.MarkedYAMLError(
                problem="an integer has more than 64 bits", problem_mark=node.start_mark
            )
        return value


_Loader.add_constructor("tag:yaml.org,2002:int", _Loader.construct_yaml_int)
