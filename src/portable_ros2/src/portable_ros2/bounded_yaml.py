"""YAML of somebody else: a few lines can also be made to take all time or all memory."""

from __future__ import annotations

from typing import Any

import yaml

LONGEST = 100_000  # characters that somebody writes by hand
DEEPEST = 50  # levels; each one more makes the next slower to read


class TooLargeError(yaml.MarkedYAMLError):
    """A text would take long to read, whether it is YAML or not."""


def load(text: str, loader: type[Any], *, has_aliases: bool = True, longest: int = LONGEST) -> Any:
    """Return what a text holds, unless it would take long to read.

    Args:
        text: in YAML.
        loader: one of PyYAML's, or like them.
        has_aliases: whether it may have some; what they stand for can be more than memory holds.
        longest: how many characters it may have.

    Raises:
        TooLargeError: if it is too large or too deep.
        yaml.YAMLError: if it is no YAML, or has aliases.
    """
    if len(text) > longest:
        raise TooLargeError(problem=f"it has more than {longest} characters")
    depth = 0
    for event in yaml.parse(text, loader):
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        if depth > DEEPEST:
            problem = f"it is nested more than {DEEPEST} levels deep"
            raise TooLargeError(problem=problem, problem_mark=event.start_mark)
        if isinstance(event, yaml.AliasEvent) and not has_aliases:
            problem = f"ROS reads no aliases such as *{event.anchor}"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=event.start_mark)
    return yaml.load(text, loader)  # noqa: S506 -- the callers' are safe
