"""Parameters given to a node in vain: it does not declare them, or a file after them overrides them."""

from __future__ import annotations

import ast
import itertools
import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any

from ros2lab import every_node
from ros2lab.diagnose.finding import Finding, at, in_a_row, line_with
from ros2lab.diagnose.launching.launch_arguments import sections_in
from ros2lab.diagnose.launching.launch_file import Launched, LaunchFile
from ros2lab.diagnose.launching.started_faults import Packages, Started, started_in
from ros2lab.diagnose.nodes.parameter_faults import declared_in, flat, is_misspelt, is_node, renamed
from ros2lab.diagnose.nodes.parameter_values import of_its_type, type_in_words
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.parameter_file import BELOW, is_for, kind_of, written_values
from ros2lab.diagnose.sources.python_source import argument, last_name, read_text
from ros2lab.diagnose.sources.spelling import may_mean, nearest
from ros2lab.diagnose.sources.static_value import UNKNOWN

# The sources of a package, and the module in which a node is made.
_Home = tuple[NodeSources, str]


def passed_over(packages: Packages, launch_files: Sequence[LaunchFile]) -> Iterator[Finding]:
    """Yield parameters that a parameter file or launch file gives to a node that does not declare them."""
    homes = _homes(packages, launch_files)
    for package, sources in packages.values():
        alike = declared_in(sources) or {}
        for path in package.parameter_files:
            inner, text = path.relative_to(package.folder).as_posix(), read_text(path)
            written = written_values(text) if sections_in(text) else []
            for key, section in itertools.groupby(written, key=attrgetter("section")):
                values = {value.name: value for value in section}
                takers = _takers(key, (package.name, inner), homes, packages, launch_files)
                for name, value in values.items():
                    # A misspelt parameter of a node that the section names is reported elsewhere.
                    if "*" in key or not any(is_misspelt(name, declared) for declared in alike):
                        place = at(package.shown(inner), value.line)
                        yield from _fault("The file", (name, value.value), values, takers, place)
    for file in launch_files:
        yield from given_in_vain(file, packages)


def set_back(started: Sequence[Started]) -> Iterator[Finding]:
    """Yield files and launch arguments of which no value counts for a node, as those that come after them do.

    A constant before a file is a default, and a file that other nodes are given too, or that has a single value, may be
    overridden on purpose.
    """
    files = {(node.launched.place, str(given)) for node in started for given in node.launched.given}
    users = Counter(file for _, file in files)
    for node in started:
        rows = [*_given_to(node)]
        last = {row.name: row for row in rows}
        sections = [*dict.fromkeys(row.section for row in rows)]
        # ROS takes the sections in the order in which each comes first; nothing is told where that makes a difference.
        if last != {row.name: row for row in sorted(rows, key=lambda row: sections.index(row.section))}:
            continue
        for source in dict.fromkeys(row.source for row in rows if row.source):
            own = [*{row.name: row for row in rows if row.source == source}.values()]
            ends = [last[row.name] for row in own]
            is_given_once = users[source] == 1 and len(own) > 1
            if _is_lost(own, ends, is_given_once=is_given_once):
                yield _lost(own, ends, node.launched)


def _is_lost(given: Sequence[_Given], ends: Sequence[_Given], *, is_given_once: bool) -> bool:
    """Return whether none of the values of a file or a launch argument counts, and certainly not on purpose.

    Args:
        given: the values.
        ends: for each of them, the one that counts.
        is_given_once: whether they are several, and no other node is given them.
    """
    if any(end.source == row.source for row, end in zip(given, ends, strict=True)):
        return False
    changed = (
        not end.is_of_file and str(row.value).lower() != str(end.value).lower()
        for row, end in zip(given, ends, strict=True)
    )
    return not given[0].is_of_file or (is_given_once and all(changed))


def _lost(given: Sequence[_Given], last: Sequence[_Given], node: Launched) -> Finding:
    """Say that values of a file or of a launch argument do not count, because those that come after them do."""
    names, values = tuple(row.name for row in given), in_a_row([repr(row.value) for row in last])
    first, source = in_a_row([f"{row.name} is {row.value!r}" for row in given]), Path(given[0].source).name
    other = Path(last[0].source).name if last[0].is_of_file else "the launch file"
    it = "them" if names[1:] else "it"
    then = f"but {other}, after it, sets {it} to {values}: the last value counts"
    cause = f"{first} in {source}, {then}."
    fix = f"give the node {source} after these values, or without those that it should set"
    if not given[0].is_of_file:
        cause = f"{first} by the launch argument {source}, {then}, so {source}:=... does not change {it}."
        fix = f"give the node {other if last[0].is_of_file else 'the other value'} first, and {in_a_row(names)} after that"
    return Finding("launch-argument", cause, node.place_of(names[0]), fix, names)


@dataclass(frozen=True)
class _Given:
    """A value that a node is given.

    Attributes:
        source: the path of a file, or the launch argument that changes the value; empty for a constant of the launch file.
        section: the key of the file below which it stands.
    """

    source: str
    is_of_file: bool
    section: str
    name: str
    value: Any


def _given_to(node: Started) -> Iterator[_Given]:
    """Yield what a node is given, in order."""
    arguments = node.launched.by_argument
    for number, given in enumerate(node.launched.given):
        if isinstance(given, Mapping):
            rows = [(arguments.get((number, name), ""), name, value) for name, value in flat(given)]
            yield from (_Given(source, False, "/**", name, value) for source, name, value in rows)
            continue
        for key, values in sections_in(read_text(Path(given))):
            if is_for(key, node.runs_as or "/"):
                yield from (_Given(given, True, key, *row) for row in values.items())


def given_in_vain(file: LaunchFile, packages: Packages) -> Iterator[Finding]:
    """Yield parameters that a launch file gives a node with another type, or only to nodes that do not declare them."""
    takers: dict[str, list[Started]] = {}
    for node in started_in(file, packages):
        yield from _of_other_type(node, file.giver.lower())
        yield from _like_a_file(node, file, packages)
        for name, _ in flat(node.launched.values):
            if BELOW not in name.split("."):
                takers.setdefault(name, []).append(node)
    given = Counter(name for node in file.nodes for name, _ in flat(node.values))
    for name, nodes in takers.items():
        # A parameter that a node from outside the workspace is given too may be meant for that node.
        if len(nodes) == given[name]:
            launched = nodes[-1].launched
            homes = [(node.sources, node.module) for node in nodes]
            value = dict(flat(launched.values))[name]
            place = nodes[0].launched.place_of(name)
            yield from _fault(file.giver, (name, value), launched.values, homes, place)


def _like_a_file(node: Started, file: LaunchFile, packages: Packages) -> Iterator[Finding]:
    """Yield that the parameters in a launch file have the levels of a parameter file, so that they become parts of the names."""
    given = {name: value for name, value in flat(node.launched.values) if BELOW in name.split(".")}
    if not given:
        return
    split = [(*name.rpartition(f"{BELOW}.")[::2], value) for name, value in given.items()]
    own = [row for row in split if is_node(row[0].strip("."), {"", node.name})]
    right = {name: value for _, name, value in own or split}
    paths = (
        (home.shown(str(p.relative_to(home.folder))), p)
        for home, _ in packages.values()
        for p in home.launch_files
    )
    text = next((read_text(path) for shown, path in paths if shown == file.shown), "")
    cause = f"These parameters have the levels of a parameter file, but launch joins all of them to one name: it sets {in_a_row([*given])}, which {node.launched.executable} does not have."
    fix = f"write parameters=[{right!r}]"
    if "yaml" in text and re.search(r"load(_all)?\(", text):
        fix = "give the path of the file itself in parameters=[...], and not what yaml reads from it"
    elif not file.shown.endswith(".py") or not all(repr(value) in text for value in right.values()):
        fix = f"give {in_a_row([*right])} directly, without the levels above {'it' if len(right) == 1 else 'them'}"
    line = line_with(text, BELOW)
    yield Finding("parameter-name", cause, at(file.shown, line) if line else node.launched.place, fix)


def _of_other_type(node: Started, giver: str) -> Iterator[Finding]:
    """Yield parameters whose values in a launch file have another type than their node declares; none of texts, which launch reads."""
    files, values = node.sources.around(node.module), dict[str, Any]()
    for given in node.launched.given:
        values = {**values, **given} if isinstance(given, Mapping) else {}  # a file may give another value
    declared = (declared_in(files) if files else None) or {}
    for name, value in ((name, value) for name, value in flat(values) if not isinstance(value, str)):
        wanted, kind = kind_of(declared.get(name, UNKNOWN)), kind_of(value)
        if wanted and kind and wanted != kind:
            cause = f"{node.launched.executable} declares {name} with {type_in_words(wanted)}, but {giver} gives it {value}, {type_in_words(kind)}, so the node does not start."
            place = node.launched.place_of(name)
            right = f"{value}.0" if (kind, wanted) == ("INTEGER", "DOUBLE") else type_in_words(wanted)
            yield Finding("parameter-type", cause, place, f"write {right} instead of {value}", (name,))


def _homes(packages: Packages, launch_files: Sequence[LaunchFile]) -> Mapping[str, list[_Home]]:
    """Return the modules in which nodes are made, by node name; "" for an unknown name."""
    found: dict[str, list[_Home]] = {}
    for _, sources in packages.values():
        for module, source in sources.sources.items():
            for name in NodeSources({module: source}).node_names:
                found.setdefault(name, []).append((sources, module))
    for node in (node for file in launch_files for node in started_in(file, packages)):
        found.setdefault(node.name, []).append((node.sources, node.module))
    return found


def _takers(
    key: str,
    path: tuple[str, str],
    homes: Mapping[str, list[_Home]],
    packages: Packages,
    launch_files: Sequence[LaunchFile],
) -> list[_Home]:
    """Return the modules whose nodes take a section; empty if a node from elsewhere may take it too."""
    name = key.rstrip("/").rpartition("/")[2]
    if "*" not in name:
        return [*homes[name], *homes.get("", [])] if name in homes else []
    started = [node for file in launch_files for node in started_in(file, packages)]
    given = [node for file in launch_files for node in file.nodes if path in node.files]
    own = [(node.sources, node.module) for node in started if path in node.launched.files]
    return own if len(own) == len(given) else []


def _fault(
    giver: str, given: tuple[str, Any], among: Mapping[Any, Any], takers: Collection[_Home], place: str
) -> Iterator[Finding]:
    name, value = given
    if name.partition(".")[0] in every_node.PARAMETERS:
        return
    declared: dict[str, Any] = {}
    for sources, module in takers:
        files = sources.around(module)
        own = declared_in(files) if files else None
        if files is None or own is None or name in own or _may_declare(files, name):
            return
        declared |= own
    # A node that declares nothing may do without the file on purpose.
    if declared:
        node = " and ".join(dict.fromkeys(module.rpartition(".")[2] for _, module in takers))
        cause = f"{giver} sets the parameter {name}, but {node} does not declare it, so ROS ignores it; {node} declares {', '.join(sorted(declared))}."
        declare = f"self.declare_parameter({name!r}, {value!r})"
        others = {other for other, _ in flat(among)}
        ends = [other for other in declared if _is_end(name, other)]
        alone = len(ends) == 1 and sum(_is_end(other, ends[0]) for other in others) == 1
        meant = [other for other in declared if may_mean(name, other, declared)]
        close = nearest(name, meant, 0.7) or nearest(name, {*meant} - others, 0.5)
        fix = f"declare it: {declare}"
        if close := ends[0] if alone else close:
            typed = of_its_type(value, declared[close]) if close not in others else ""
            right = renamed(name, close, others) + typed
            fix = right if alone or is_misspelt(name, close) else f"{right}, or {fix}"
        yield Finding("parameter-name", cause, place, fix)


def _is_end(name: str, other: str) -> bool:
    """Return whether two names differ only by the levels above one of them, such as `pid.kp` and `kp`."""
    return f".{name}".endswith(f".{other}") or f".{other}".endswith(f".{name}")


def _may_declare(files: NodeSources, name: str) -> bool:
    """Return whether nodes may declare a parameter other than by a call that names it."""
    for source in files.sources.values():
        called = {id(node.func) for node in source.calls}
        rows = [
            argument(call, 1, "parameters")
            for call in source.calls
            if last_name(call.func) == "declare_parameters"
        ]
        written = {id(node) for row in rows if row for node in ast.walk(row)}
        for node in source.nodes:
            match node:
                case ast.Constant(value=text) if text == name and id(node) not in written:
                    return True
                case ast.Attribute(attr=attr) if attr.startswith("declare_") and id(node) not in called:
                    return True
                case ast.keyword(
                    arg="allow_undeclared_parameters" | "automatically_declare_parameters_from_overrides"
                ):
                    return True
    return False
