"""Compares the sections of parameter files with the full names of the nodes that were started with them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import PurePath

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_arguments import sections_in
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.parameter_faults import other_name
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.transcript import Step, words_in
from ros2lab.diagnose.sources.parameter_file import is_for, line_of
from ros2lab.diagnose.sources.python_source import read_text

_LOGGED = re.compile(
    r"^(?:\[(?P<process>[\w.]+)-\d+\] )?\[(?:DEBUG|INFO|WARN|ERROR|FATAL)\] (?:\[[\d.]+\] )?\[(?P<name>[\w.]+)\]: "
)


@dataclass(frozen=True)
class _Ran:
    """A node of the workspace that was started with a parameter file, and the names that a section for it may have."""

    runs_as: str
    names: frozenset[str]
    file: str


def sections_read(error: ErrorText, look: Look) -> tuple[list[Finding], set[str]]:
    """Return findings about sections that no node reads, and the shown paths of files that a node reads."""
    found, served = list[Finding](), set[str]()
    for ran in (ran for step in error.steps for ran in _ran(step, look)):
        for package in look.packages:
            for path in (file for file in package.parameter_files if file.name == ran.file):
                shown, text = package.shown(path.relative_to(package.folder).as_posix()), read_text(path)
                keys = [key for key, _ in sections_in(text)]
                meant = [key for key in keys if key.rstrip("/").rpartition("/")[2] in ran.names]
                if any(is_for(key, ran.runs_as) for key in keys):
                    served.add(shown)
                elif len(keys) == 1 or len(meant) == 1:
                    (key,) = meant or keys
                    found.append(other_name(key, ran.runs_as, shown, f"{shown}:{line_of(key, text) or 1}"))
    return found, served


def _ran(step: Step, look: Look) -> Iterator[_Ran]:
    """Yield the nodes that a command started with a parameter file."""
    match words_in(step.command):
        case ["ros2", "run", package, program, *rest]:
            yield from _run(package, program, rest, _logged(step), look)
        case ["ros2", "launch", _, file, *_]:
            yield from _launched(file, step, look)


def _run(package: str, program: str, rest: list[str], logged: set[str], look: Look) -> Iterator[_Ran]:
    """Yield the node of a program, once for each parameter file that the command gives it."""
    pairs = [*pairwise(rest)]
    files = [value for option, value in pairs if option == "--params-file"]
    given = dict(
        value.split(":=", 1) for option, value in pairs if option in ("-r", "--remap") and ":=" in value
    )
    home = look.package(package)
    points = home.points if home else ()
    module = next((point.module for point in points if point.name == program), "")
    if home is None or not files:
        return
    sources = look.sources(home)
    here = [name for name, (source, _) in sources.node_names.items() if source.name == module and name]
    whole = sources.full_names.get(here[0], "") if len(here) == 1 else ""
    space, _, name = whole.rpartition("/")
    name, space = given.get("__node", name), given.get("__ns", space).rstrip("/")
    if len(logged) == 1 or name:
        runs_as = next(iter(logged)) if len(logged) == 1 else f"{space}/{name}"
        names = frozenset({*here, program, runs_as.rpartition("/")[2]})
        yield from (_Ran(runs_as, names, PurePath(file).name) for file in files)


def _launched(file: str, step: Step, look: Look) -> Iterator[_Ran]:
    """Yield the nodes that a launch file started with a parameter file and that logged something."""
    started = [
        node for node in look.launched.values() if node.launched.place.partition(":")[0].endswith(file)
    ]
    for node in started:
        logged = _logged(step, str(node.launched.executable))
        if len(logged) == 1:
            (runs_as,) = logged
            names = frozenset({node.module.rpartition(".")[2], str(node.launched.executable), node.name})
            yield from (_Ran(runs_as, names, PurePath(path).name) for _, path in node.launched.files)


def _logged(step: Step, process: str = "") -> set[str]:
    """Return the full names of the nodes that logged something; logger names have dots instead of slashes."""
    matches = filter(None, map(_LOGGED.match, step.lines))
    return {f"/{match['name'].replace('.', '/')}" for match in matches if (match["process"] or "") == process}
