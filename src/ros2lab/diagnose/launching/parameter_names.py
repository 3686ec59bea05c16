"""Parameters given to a node in vain: it does not declare them, or a file after them overrides them."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ros2lab import every_node
from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.launching.launch_arguments import sections_in
from ros2lab.diagnose.launching.launch_file import LaunchFile
from ros2lab.diagnose.launching.started_faults import Packages, Started, started_in
from ros2lab.diagnose.nodes.parameter_faults import declared_in, is_node
from ros2lab.diagnose.nodes.parameter_values import of_its_type, type_in_words
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.parameter_file import kind_of, line_of
from ros2lab.diagnose.sources.python_source import read_text
from ros2lab.diagnose.sources.spelling import is_near_miss, may_mean, nearest, write_instead
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
            for key, values in sections_in(text):
                takers = _takers(key, (package.name, inner), homes, packages, launch_files)
                for name, value in _flat(values):
                    # A misspelt parameter is reported elsewhere.
                    if not any(is_near_miss(name, declared) for declared in alike):
                        place = at(package.shown(inner), _line(name, key, text))
                        yield from _fault("The file", (name, value), values, takers, place)
    for file in launch_files:
        yield from _of_launch_file(file, packages)


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


def _of_launch_file(file: LaunchFile, packages: Packages) -> Iterator[Finding]:
    """Yield parameters that a launch file gives a node with another type, or only to nodes that do not declare them."""
    takers: dict[str, list[Started]] = {}
    for node in started_in(file, packages):
        yield from _of_other_type(node)
        for name, _ in _flat(node.launched.values):
            takers.setdefault(name, []).append(node)
    given = Counter(name for node in file.nodes for name, _ in _flat(node.values))
    for name, nodes in takers.items():
        # A parameter that a node from outside the workspace is given too may be meant for that node.
        if len(nodes) == given[name]:
            launched = nodes[-1].launched
            homes = [(node.sources, node.module) for node in nodes]
            value = dict(_flat(launched.values))[name]
            place = nodes[0].launched.place
            yield from _fault("The launch file", (name, value), launched.values, homes, place)


def _of_other_type(node: Started) -> Iterator[Finding]:
    """Yield parameters whose values in a launch file have another type than their node declares; none of texts, which launch reads."""
    files, values = node.sources.around(node.module), dict[str, Any]()
    for given in node.launched.given:
        values = {**values, **given} if isinstance(given, Mapping) else {}  # a file may give another value
    declared = (declared_in(files) if files else None) or {}
    for name, value in ((name, value) for name, value in _flat(values) if not isinstance(value, str)):
        wanted, kind = kind_of(declared.get(name, UNKNOWN)), kind_of(value)
        if wanted and kind and wanted != kind:
            cause = f"{node.launched.executable} declares {name} with {type_in_words(wanted)}, but the launch file gives it {value}, {type_in_words(kind)}, so the node does not start."
            right = f"{value}.0" if (kind, wanted) == ("INTEGER", "DOUBLE") else type_in_words(wanted)
            yield Finding(
                "parameter-type", cause, node.launched.place, f"write {right} instead of {value}", (name,)
            )


def _homes(packages: Packages, launch_files: Sequence[LaunchFile]) -> Mapping[str, list[_Home]]:
    """Return the modules in which nodes are made, by node name; "" for an unknown name."""
    found: dict[str, list[_Home]] = {}
    for _, sources in packages.values():
        for module, source in sources.sources.items():
            for name in NodeSources({module: source}).node_names():
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


def _flat(values: Mapping[Any, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Yield parameters by their full names, such as `wheel.radius`."""
    for key, value in values.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def _line(name: str, section: str, text: str) -> int | None:
    first = line_of(section, text) or 1
    written = re.compile(rf"(?<![\w.])['\"]?{re.escape(name.rpartition('.')[2])}['\"]?\s*:")
    lines = enumerate(text.splitlines()[first:], first + 1)
    return next((number for number, line in lines if written.search(line)), first)


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
        others = {other for other, _ in _flat(among)}
        meant = [other for other in declared if may_mean(name, other, declared)]
        close = nearest(name, meant, 0.7) or nearest(name, {*meant} - others, 0.5)
        fix = f"declare it: {declare}"
        if close:
            typed = of_its_type(value, declared[close]) if close not in others else ""
            fix = f"{write_instead(close, name, others)}{typed}, or declare it: {declare}"
        yield Finding("parameter-name", cause, place, fix)


def _may_declare(files: NodeSources, name: str) -> bool:
    """Return whether nodes may declare a parameter other than by a call that names it."""
    for source in files.sources.values():
        called = {id(node.func) for node in source.calls}
        for node in source.nodes:
            match node:
                case ast.Constant(value=text) if text == name:
                    return True
                case ast.Attribute(attr=attr) if attr.startswith("declare_") and id(node) not in called:
                    return True
                case ast.keyword(
                    arg="allow_undeclared_parameters" | "automatically_declare_parameters_from_overrides"
                ):
                    return True
    return False


def _given_by(path: Path, node: Started) -> Iterator[tuple[str, Any]]:
    """Yield the parameters that a file sets for a node; none if it cannot be read."""
    for key, parameters in sections_in(read_text(path)):
        if is_node(key, {node.name}):
            yield from ((str(name), value) for name, value in parameters.items())
