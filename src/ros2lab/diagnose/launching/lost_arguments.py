"""Launch configurations that do not exist when launch loads a file: declared but not added, or given by another file."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.launching.unlisted import unlisted
from ros2lab.diagnose.sources.python_source import PythonSource, read_text

_MISSING = re.compile(r"launch configuration '(?P<name>[^']+)' does not exist")


def lost_argument(said: str, path: Path, source: PythonSource, files: Iterable[Path]) -> list[Finding] | None:
    """Return why a launch configuration does not exist; empty if another file gives it, None if launch says something else."""
    match = _MISSING.search(said)
    if match is None:
        return None
    name = match["name"]
    if lost := next(not_added(name, source), None):
        return [lost]
    others = (read_text(other) for other in files if other != path)
    if any(path.name in text and name in text for text in others):
        return []  # it is included, with this argument
    used = (
        node
        for node in source.nodes
        if isinstance(node, ast.Call) and _is(node, "LaunchConfiguration", source)
    )
    lines = [node.lineno for node in used if _first(node) == name]
    return [
        Finding(
            SAID, f"launch cannot load this file: {said.rstrip('.')}.", source.at(lines[0] if lines else 1)
        )
    ]


def not_added(name: str, source: PythonSource) -> Iterator[Finding]:
    """Yield the declaration of an argument that is not in the launch description."""
    for action in unlisted(source):
        if action.kind == "DeclareLaunchArgument" and name in map(_first, action.made):
            kept = action.name or "it"
            cause = f"The argument {name} is declared here, but {kept} is not in the launch description, so LaunchConfiguration({name!r}) does not exist."
            yield Finding("launch-lost", cause, source.at(action.statement), action.listing)


def _is(call: ast.Call, name: str, source: PythonSource) -> bool:
    return (source.resolve(call.func) or "").endswith(f".{name}")


def _first(call: ast.Call) -> object:
    """Return the value of a call's first argument, if it is written there."""
    given = [
        *call.args,
        *(keyword.value for keyword in call.keywords if keyword.arg in ("name", "variable_name")),
    ]
    return given[0].value if given and isinstance(given[0], ast.Constant) else None
