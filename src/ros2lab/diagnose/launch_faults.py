"""What launch files name, and whether it is there."""

from __future__ import annotations

import ast
import xml.etree.ElementTree as ET
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ros2lab.diagnose import interfaces
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.package import SourcePackage
from ros2lab.diagnose.python_source import PythonSource, read_source
from ros2lab.diagnose.spelling import did_you_mean, nearest
from ros2lab.diagnose.static_value import UNKNOWN, dotted, evaluate
from ros2lab.diagnose.syntax import syntax_finding

_SHARE = "share:"  # stands for a package's share folder in a path


@dataclass(frozen=True)
class Launched:
    """A node that a launch file starts; what is not known is `UNKNOWN`.

    Attributes:
        files: the parameter files that it is given, as (package, path below its share folder).
        remapped: the topics that get other names.
    """

    package: Any
    executable: Any
    name: Any
    files: tuple[tuple[str, str], ...]
    remapped: tuple[str, ...]
    place: str


@dataclass(frozen=True)
class LaunchFile:
    """A launch file, with what it starts and what is wrong with the file itself."""

    shown: str
    nodes: tuple[Launched, ...]
    faults: tuple[Finding, ...] = ()


def read_launch_file(path: Path, shown: str) -> LaunchFile:
    """Read a launch file; one written in YAML is passed over."""
    if path.suffix == ".xml":
        return _read_xml(path, shown)
    if path.suffix != ".py":
        return LaunchFile(shown, ())
    source = read_source(path, "launch_file", shown)
    if source.tree is not None and source.fault:
        return LaunchFile(shown, (), (syntax_finding("launch-syntax", source),))
    functions = [node.name for node in source.nodes if isinstance(node, ast.FunctionDef)]
    faults = []
    if "generate_launch_description" not in {*functions, *source.names}:
        faults.append(
            Finding(
                "launch-function",
                f"{shown} has no function generate_launch_description, which ros2 launch calls."
                f"{did_you_mean('generate_launch_description', functions)}",
                source.at(1),
                "write def generate_launch_description(): and return LaunchDescription([...])",
            )
        )
    return LaunchFile(shown, tuple(_nodes(source)), tuple(faults))


def _nodes(source: PythonSource) -> Iterator[Launched]:
    names: dict[str, Any] = {}
    calls = _calls(source)
    for node in source.nodes:
        if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
            name = node.targets[0].id
            names[name] = UNKNOWN if name in names else evaluate(node.value, names, calls)
    for node in source.nodes:
        if not isinstance(node, ast.Call):
            continue
        target = source.resolve(node.func) or ""
        if not target.startswith("launch_ros.actions.") or not target.endswith("Node"):
            continue
        given = {k.arg: evaluate(k.value, names, calls) for k in node.keywords if k.arg}
        line = next((k.value for k in node.keywords if k.arg == "executable"), node)
        remappings = given.get("remappings", [])
        renamed = (
            [
                pair[0].lstrip("/")
                for pair in remappings
                if isinstance(pair, list) and pair and isinstance(pair[0], str)
            ]
            if isinstance(remappings, list)
            else []
        )
        yield Launched(
            given.get("package", UNKNOWN),
            given.get("executable", UNKNOWN),
            given.get("name"),
            tuple(_files(given.get("parameters"))),
            tuple(renamed),
            source.at(line),
        )


def _files(parameters: Any) -> Iterator[tuple[str, str]]:
    for one in parameters if isinstance(parameters, list) else ():
        if isinstance(one, str) and one.startswith(_SHARE):
            package, _, path = one.removeprefix(_SHARE).partition("/")
            yield package, path


def _calls(source: PythonSource) -> Mapping[str, Any]:
    def share(package: str) -> str:
        return f"{_SHARE}{package}"

    def joined(*parts: Any) -> Any:
        flat = [inner for part in parts for inner in (part if isinstance(part, list) else [part])]
        return "/".join(flat) if all(isinstance(part, str) for part in flat) else UNKNOWN

    known = {
        "ament_index_python.packages.get_package_share_directory": share,
        "ament_index_python.get_package_share_directory": share,
        "launch_ros.substitutions.FindPackageShare": share,
        "launch.substitutions.PathJoinSubstitution": joined,
        "os.path.join": joined,
        "str": str,
    }
    spelt = {}
    for node in source.nodes:
        name = dotted(node) if isinstance(node, (ast.Name, ast.Attribute)) else None
        if name and (target := source.resolve(node) or name) in known:
            spelt[name] = known[target]
    return spelt


def _read_xml(path: Path, shown: str) -> LaunchFile:
    try:
        root = ET.fromstring(path.read_bytes())  # noqa: S314 -- a file of the workspace; entities are not fetched
    except (ET.ParseError, OSError) as error:
        cause = f"{shown} is not valid XML: {error}."
        return LaunchFile(shown, (), (Finding("launch-syntax", cause, shown, "mend the XML at that line"),))

    def plain(text: str | None) -> Any:
        return UNKNOWN if text is None or "$(" in text else text

    nodes = [
        Launched(
            plain(one.get("pkg")),
            plain(one.get("exec")),
            plain(one.get("name")) if one.get("name") else None,
            (),
            (),
            shown,
        )
        for one in root.iter("node")
    ]
    return LaunchFile(shown, tuple(nodes))


def launch_faults(
    launch_file: LaunchFile,
    packages: Mapping[str, SourcePackage],
    executables: Mapping[str, Collection[str] | None],
) -> Iterator[Finding]:
    """Yield what a launch file names that is not there.

    Args:
        launch_file: the file.
        packages: those of the workspace, by name.
        executables: those of each package; None where they are not known.
    """
    yield from launch_file.faults
    for node in launch_file.nodes:
        if isinstance(node.package, str) and node.package not in packages:
            wanted = nearest(node.package, packages, 0.8)
            if (
                wanted
                and interfaces.folder_of(node.package) is None
                and node.package not in interfaces.PACKAGES
            ):
                yield Finding(
                    "launch-package",
                    f"The launch file starts a node of the package {node.package}, and the package is called {wanted}.",
                    node.place,
                    f"write package={wanted!r}",
                )
        elif isinstance(node.package, str) and isinstance(node.executable, str):
            there = executables.get(node.package)
            if there is not None and node.executable not in there:
                yield Finding(
                    "launch-executable",
                    f"The launch file starts {node.executable}, and {node.package} has no such executable: "
                    f"it has {', '.join(sorted(there)) or 'none'}.{did_you_mean(node.executable, there)}",
                    node.place,
                    "write the executable's name as it stands in the entry points of setup.py",
                )
        for package, path in node.files:
            if package in packages and not _is_installed(packages[package], path):
                yield Finding(
                    "parameter-file-missing",
                    f"The launch file gives the parameter file {path} of {package}, and that is not installed: "
                    "the nodes keep their defaults.",
                    node.place,
                    f"make the file {path}, and add it to data_files in setup.py",
                )


def _is_installed(package: SourcePackage, path: str) -> bool:
    data_files = package.setup.data_files if package.setup else None
    if data_files is None:
        return True
    below = f"share/{package.name}/"
    targets = {f"{folder}/{file.rpartition('/')[2]}" for folder, files in data_files for file in files}
    return (
        below + path in targets or (package.folder / path).is_file()
    )  # that one is told as not-in-data-files
