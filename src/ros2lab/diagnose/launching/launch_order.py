"""Parameters that a launch file gives a node, and that a parameter file after them overrides."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_arguments import sections_in
from ros2lab.diagnose.launching.started_faults import Started
from ros2lab.diagnose.nodes.parameter_faults import is_node
from ros2lab.diagnose.sources.python_source import read_text


def set_back(started: list[Started]) -> Iterator[Finding]:
    """Yield parameters of a node that a file after them sets to another value: the last value counts.

    A file before another file, or before parameters, is the usual way to write defaults.
    """
    for node in started:
        known: dict[str, Any] = {}
        for given in node.launched.given:
            if isinstance(given, Mapping):
                known |= given
                continue
            for name, value in _given_by(Path(given), node):
                if name in known and known[name] != value:
                    shown = Path(given).name
                    cause = f"{name} is {known[name]} here, but {shown}, which comes after it, sets it to {value}: the last value counts."
                    fix = f"write {shown} first in parameters=[...], and the values that should win after it"
                    yield Finding("launch-argument", cause, node.launched.place, fix, (name,))


def _given_by(path: Path, node: Started) -> Iterator[tuple[str, Any]]:
    """Yield the parameters that a file sets for a node; none if it cannot be read."""
    for key, parameters in sections_in(read_text(path)):
        if is_node(key, {node.name}):
            yield from ((str(name), value) for name, value in parameters.items())
