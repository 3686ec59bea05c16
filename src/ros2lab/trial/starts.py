"""The programs of a workspace as they are started in a trial: each as its launch file does, as often as that does."""

from __future__ import annotations

import ast
import contextlib
import itertools
import json
from collections.abc import Iterator, Mapping
from pathlib import Path

from ros2lab.diagnose.launching.started_faults import Started, started_in
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.packaging.installed import prefix_of
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.parameter_file import ParameterFileError, read_parameter_file
from ros2lab.diagnose.sources.python_source import read_text
from ros2lab.grading.watching.job import Program

MOST_PROGRAMS = 10


def executable_of(program: str) -> str:
    """Return the executable that a program runs, which may be one of several: `member` of `member (r2)`."""
    return program.partition(" (")[0]


def programs_of(look: Look, overlay: Mapping[str, str], folder: Path) -> list[Program]:
    """Return the programs to start: of each executable the first that launch starts, and then the others of each.

    Args:
        look: the workspace.
        overlay: the environment in which it is used.
        folder: where the files that launch would write can be put.
    """
    private = ("HOME", "PWD", "OLDPWD", "SHLVL", "_")
    environ = {name: value for name, value in overlay.items() if name not in private}
    programs, others, taken = list[Program](), list[Program](), set[str]()

    def program(package: SourcePackage, path: Path, start: Started | None, label: str = "") -> Program:
        """Return a start of an executable; what a program notes is found by its name, so no other start has it."""
        numbers = (f"{label} {number}".strip() for number in itertools.count(2))
        names = (f"{path.name} ({one})" if one else path.name for one in itertools.chain([label], numbers))
        name = next(name for name in names if name not in taken)
        taken.add(name)
        if name != path.name:
            (folder / name).symlink_to(path)
            path = folder / name
        given = (
            _arguments(start, folder / f"{name}.yaml") if start else own_file(package, executable_of(name))
        )
        return Program(name, [path, *given], environ)

    for package in look.packages:
        prefix = prefix_of(look.root, package.name)
        for path in sorted((prefix / "lib" / package.name).glob("*")) if prefix else ():
            if not path.is_file() or not path.stat().st_mode & 0o111:
                continue
            first = look.launched.get((package.name, path.name))
            programs.append(program(package, path, first))
            others += [program(package, path, *other) for other in (_others(look, first) if first else ())]
    return [*programs, *others][:MOST_PROGRAMS]


def _others(look: Look, first: Started) -> Iterator[tuple[Started, str]]:
    """Yield the other starts of an executable in its launch file, each with what tells it from the first, if anything."""
    files = (started_in(file, look.with_sources) for file in look.launch_files)
    beside = next((nodes for nodes in files if first in nodes), [])
    known = set[str]()
    for start in (node for node in beside if node.package is first.package):
        given = start.launched
        what = repr((start.name, start.namespace, given.remappings, given.given, given.arguments))
        if given.executable == first.launched.executable and what not in known:
            names = ((start.name, first.name), (start.namespace, first.namespace))
            if known:  # it is not the first
                yield start, next((own.strip("/").replace("/", ".") for own, its in names if own != its), "")
            known.add(what)


def own_file(package: SourcePackage, program: str) -> list[str]:
    """Return arguments with the only parameter file that names the node of a program; else empty."""
    found = dict[Path, set[str]]()
    for path in package.parameter_files:
        with contextlib.suppress(ParameterFileError, OSError):
            content = read_parameter_file(read_text(path))
            if isinstance(content, Mapping):
                found[path] = {str(name).rpartition("/")[2] for name in content}
    point = next(
        (
            entry_point
            for entry_point in (package.setup.entry_points if package.setup else None) or ()
            if entry_point.name == program
        ),
        None,
    )
    source = package.sources.get(point.module) if point else None
    texts = {node.value for node in source.nodes if isinstance(node, ast.Constant)} if source else set()
    named = [path for path, names in found.items() if not names.isdisjoint(texts)]
    return ["--ros-args", "--params-file", str(named[0])] if len(named) == 1 else []


def _arguments(started: Started, values: Path) -> list[str]:
    """Return the arguments that launch gives a program; files beside `values` hold its parameters, as launch writes them."""
    given, files = started.launched, list[Path]()
    for number, entry in enumerate(given.given):
        files.append(Path(entry) if isinstance(entry, str) else values.with_stem(f"{values.stem}-{number}"))
        if isinstance(entry, Mapping):
            files[-1].write_text(json.dumps({"/**": {"ros__parameters": {**entry}}}))
    names = {"__node": given.name, "__ns": started.namespace}
    renamed = [*((old, new) for old, new in names.items() if new), *given.remappings]
    return [
        *given.arguments,
        "--ros-args",
        *(word for old, new in renamed for word in ("-r", f"{old}:={new}")),
        *(word for path in files if path.is_file() for word in ("--params-file", str(path))),
    ]
