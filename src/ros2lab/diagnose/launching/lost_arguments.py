"""Launch configurations that do not exist when launch loads a file: declared but not added, or given by another file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.launching.launch_arguments import arguments_named
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
    used = (call for asked, call in arguments_named(source, "LaunchConfiguration") if asked == name)
    place = source.at(next(used, 1))
    return [Finding(SAID, f"launch cannot load this file: {said.rstrip('.')}.", place)]


def not_added(name: str, source: PythonSource) -> Iterator[Finding]:
    """Yield the declaration of an argument that is not in the launch description."""
    for action in unlisted(source):
        declared = (arguments_named(source, "DeclareLaunchArgument", within=call) for call in action.made)
        if any(declared_name == name for found in declared for declared_name, _ in found):
            kept = action.name or "it"
            cause = f"The argument {name} is declared here, but {kept} is not in the launch description, so LaunchConfiguration({name!r}) does not exist."
            yield Finding("launch-lost", cause, source.at(action.statement), action.listing)
