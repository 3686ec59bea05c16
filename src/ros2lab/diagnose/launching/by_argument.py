"""Tell what a node is given by each launch argument: its parameters that differ when the file is loaded with another value.

It runs in the process that loads launch files.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

_FLIPPED = {"true": "false", "false": "true"}
_Nodes = Sequence[Mapping[str, Any]]
_Load = Callable[[Mapping[str, str]], Mapping[str, Any]]
# A parameter: the number of its node, that of its entry there, and its name.
_Place = tuple[int, int, str]


def note_arguments(told: Mapping[str, Any], load: _Load) -> bool:
    """Note at the nodes of a launch file the arguments that give their parameters; return whether there are any.

    Only of a file in which a later entry may set such a parameter, too, and not what differs without another value.

    Args:
        told: what the file starts, as `load` tells it.
        load: loads the file with values for some arguments.
    """
    nodes = told.get("nodes", [])
    values = {name: value for name, value in told.get("arguments", {}).items() if value is not None}
    if not values or not any(isinstance(entry, dict) for node in nodes for entry in node["given"][:-1]):
        return False
    found = [*_tried(nodes, load, values)]
    again = _values(nodes, load({})) if found else {}
    steady = {place for place, pair in again.items() if pair[0] == pair[1]}
    rows = [(place, name) for place, name in found if place in steady]
    for (node, *place), name in rows:
        nodes[node]["by_argument"].append((*place, name))
    return bool(rows)


def _tried(nodes: _Nodes, load: _Load, values: Mapping[str, str]) -> Iterator[tuple[_Place, str]]:
    """Yield the parameters that arguments change: all at once, and in halves where that does not tell them apart."""
    given = {name: _another(value, step) for step, (name, value) in enumerate(values.items(), 1)}
    pairs = _values(nodes, load(given))
    changed = {place: pair for place, pair in pairs.items() if pair[0] != pair[1]}
    rows = [
        (place, name)
        for place, pair in changed.items()
        for name, value in values.items()
        if len(values) == 1 or [str(v).lower() for v in pair] == [value.lower(), given[name].lower()]
    ]
    is_whole = len(pairs) == len(_values(nodes, {"nodes": nodes}))
    if len(values) == 1 or (is_whole and [place for place, _ in rows] == [*changed]):
        yield from rows
        return
    names = [*values]
    for half in (names[: len(names) // 2], names[len(names) // 2 :]):
        yield from _tried(nodes, load, {name: values[name] for name in half})


def _another(value: str, step: int) -> str:
    """Return another value of an argument, of the same kind as far as its text tells, and another one for each step."""
    if value.removeprefix("-").isdecimal():
        return str(int(value) + step)
    return _FLIPPED.get(value.lower(), f"{value}{step}1" if value[-1:].isdecimal() else f"{value}_{step}")


def _values(nodes: _Nodes, told: Mapping[str, Any]) -> dict[_Place, tuple[Any, Any]]:
    """Return the values of the parameters of nodes, here and as told, without those of a node of which more differs."""
    others = told.get("nodes", [])
    if [node["executable"] for node in nodes] != [node["executable"] for node in others]:
        return {}
    return {
        (place, number, name): (entry[name], there[name])
        for place, (node, other) in enumerate(zip(nodes, others, strict=True))
        if _rest(node) == _rest(other)
        for number, (entry, there) in enumerate(zip(node["given"], other["given"], strict=True))
        if isinstance(entry, dict)
        for name in entry
    }


def _rest(node: Mapping[str, Any]) -> dict[str, Any]:
    """Return how a node is started, with only the names of its parameters."""
    names = [entry if isinstance(entry, str) else [*entry] for entry in node["given"]]
    return {**node, "given": names, "by_argument": None}


def parameters_in_order(
    parameters: list[Any], context: Any, text: Callable[[Any], str | None]
) -> Iterator[Any]:
    """Yield a node's parameters in order: the path of each file, and dicts of the others by name."""
    from launch_ros.parameter_descriptions import ParameterFile
    from launch_ros.utilities import evaluate_parameters, normalize_parameters

    for entry in normalize_parameters(parameters):
        if isinstance(entry, dict):
            yield from evaluate_parameters(context, [entry])
        elif isinstance(entry, ParameterFile):
            yield os.path.realpath(str(text(entry)))
