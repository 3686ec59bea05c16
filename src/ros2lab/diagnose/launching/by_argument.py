"""Find which parameters of a node a launch argument changes: those that differ when the file is loaded with another value.

It runs in the process that loads launch files.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any

_FLIPPED = {"true": "false", "false": "true"}


def note_arguments(
    told: Mapping[str, Any], load: Callable[[Mapping[str, str]], Mapping[str, Any]], longest: float
) -> None:
    """Note at the nodes of a launch file the arguments that give their parameters, where a later entry may set these too.

    Args:
        told: what the file starts, as `load` tells it.
        load: loads the file with values for some arguments.
        longest: the processor time in s of this process after which no argument is tried any more.
    """
    nodes = told.get("nodes", [])
    may_be_lost = any(isinstance(entry, dict) for node in nodes for entry in node["given"][:-1])
    for name, value in told["arguments"].items() if may_be_lost else ():
        if value is None or time.process_time() > longest:
            continue
        others = load({name: _another(value)}).get("nodes", [])
        if [node["executable"] for node in others] == [node["executable"] for node in nodes]:
            for node, other in zip(nodes, others, strict=True):
                node["by_argument"] += [(*place, name) for place in _changed(node, other)]


def _another(value: str) -> str:
    """Return another value of an argument, of the same kind as far as its text tells."""
    if value[-1:].isdecimal():
        return value[:-1] + ("8" if value[-1] == "9" else str(int(value[-1]) + 1))
    return _FLIPPED.get(value.lower(), f"{value}_")


def _changed(node: Mapping[str, Any], other: Mapping[str, Any]) -> Iterator[tuple[int, str]]:
    """Yield the parameters of a node that are others now, each with the number of its entry; none if more than these is."""
    if _rest(node) == _rest(other):
        for number, (entry, there) in enumerate(zip(node["given"], other["given"], strict=True)):
            if isinstance(entry, dict):
                yield from ((number, name) for name in entry if entry[name] != there[name])


def _rest(node: Mapping[str, Any]) -> dict[str, Any]:
    """Return how a node is started, with only the names of its parameters."""
    names = [entry if isinstance(entry, str) else [*entry] for entry in node["given"]]
    return {**node, "given": names, "by_argument": None}
