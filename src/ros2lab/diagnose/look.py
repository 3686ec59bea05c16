"""Check a whole workspace: its sources, what was installed from them, and a terminal's environment."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

from ros2lab import course
from ros2lab.diagnose.code.bare_imports import bare_imports
from ros2lab.diagnose.code.imports import hidden_types, shadow_faults
from ros2lab.diagnose.finding import Finding, endless, ranked, without_loss
from ros2lab.diagnose.launching.awaited_ends import awaited_ends
from ros2lab.diagnose.launching.keyboards import keyboard_faults
from ros2lab.diagnose.launching.launch_faults import launch_faults
from ros2lab.diagnose.launching.launch_file import LaunchFile, read_launch_file
from ros2lab.diagnose.launching.launch_loaded import load
from ros2lab.diagnose.launching.parameter_names import passed_over, set_back
from ros2lab.diagnose.launching.remapped_names import unknown_names
from ros2lab.diagnose.launching.shared_names import Name, SharedNames
from ros2lab.diagnose.launching.started_faults import (
    Started,
    alternatives,
    are_alone,
    sections_apart,
    started_faults,
    started_in,
)
from ros2lab.diagnose.net import guarded
from ros2lab.diagnose.nodes.environments import Program, environment_apart
from ros2lab.diagnose.nodes.parameter_faults import file_faults
from ros2lab.diagnose.nodes.partners import Partners
from ros2lab.diagnose.nodes.service_faults import service_faults
from ros2lab.diagnose.nodes.taken_names import named_alike, taken_packages
from ros2lab.diagnose.nodes.topic_faults import End, ends_of, topic_faults
from ros2lab.diagnose.packaging.build_order import BuildOrder
from ros2lab.diagnose.packaging.for_ros import is_for_ros
from ros2lab.diagnose.packaging.installed import environment_faults, install_faults, prefix_of
from ros2lab.diagnose.packaging.interface_files import interface_faults
from ros2lab.diagnose.packaging.layout_faults import duplicate_faults, layout_faults
from ros2lab.diagnose.packaging.manifest_faults import dependency_circle, homes_of, manifest_faults
from ros2lab.diagnose.packaging.packaging_faults import packaging_faults
from ros2lab.diagnose.rules import source_faults
from ros2lab.diagnose.sources.beyond import Beyond, OtherFiles
from ros2lab.diagnose.sources.file_texts import is_endless
from ros2lab.diagnose.sources.made_modules import is_made, written_modules
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.package import SourcePackage, discover
from ros2lab.diagnose.sources.python_source import PythonSource, read_source, read_text


def workspace_around(folder: Path) -> Path | None:
    """Return the workspace in or above a folder: the nearest one with a `src`, else the nearest package.

    None if there is none. Nothing above the student's own folder is searched.
    """
    folders = [folder, *folder.parents]
    homes = [number for number, candidate in enumerate(folders) if (candidate / course.MARKER).is_file()]
    if homes:
        del folders[homes[0] + 1 :]
    for candidate in folders:
        if (
            (candidate / "src").is_dir()
            and not (candidate / "package.xml").is_file()
            and candidate.name != "src"
        ):
            return candidate
    return next(
        (
            candidate
            for candidate in folders
            if (candidate / "package.xml").is_file() or (candidate / "setup.py").is_file()
        ),
        None,
    )


def seen_of(root: Path) -> str:
    """Return which files of a workspace are checked, in words."""
    look = Look(root.absolute(), loads=True)
    if not look.packages:
        return "a workspace in which colcon sees no package"
    names = ", ".join(package.name for package in look.packages)
    files = sum(len(package.sources) for package in look.packages) + len(look.launch_files)
    is_built = any(prefix_of(look.root, package.name) for package in look.packages)
    built = "and at what is installed" if is_built else "and found nothing built in install"
    only_read = [file.shown for file in look.launch_files if not file.is_loaded]
    unloaded = (
        f" (of {', '.join(only_read)} only the text, because launch could not load it by itself)"
        if only_read
        else ""
    )
    return f"{files} files of {names}{unloaded}, {built}"


class Look:
    """What can be learnt about a workspace without running its programs.

    Without a root there is no workspace: nothing is in it, and nothing is wrong.

    Args:
        root: the folder of the workspace or of a package.
        environ: the environment of the terminal in which it is used; None skips checking it.
        loads: whether launch loads the launch files, in a separate process; otherwise they are only parsed.
        runs: whether a setup.py may be run there; None if it may where launch files are loaded.
    """

    def __init__(
        self,
        root: Path | None,
        environ: Mapping[str, str] | None = None,
        *,
        loads: bool = False,
        runs: bool | None = None,
    ) -> None:
        self.root, self.environ = root or Path(), environ
        self.packages, self.passed_over = discover(root) if root else ([], [])
        # Python, setuptools and launch would read them to an end that never comes.
        own = (path for package in self.packages for path in package.own_files())
        self._endless = [path for path in own if is_endless(path)]
        self.loads = loads and not self._endless
        for package in self.packages:
            package.is_run = (loads if runs is None else runs) and not self._endless
        self._is_workspace = root is not None
        self._sources: dict[Path, NodeSources] = {}

    def __bool__(self) -> bool:
        """Return whether there is a workspace."""
        return self._is_workspace

    @cached_property
    def findings(self) -> list[Finding]:
        """Everything that is wrong, the likeliest cause first."""
        return ranked(without_loss(finding, self.root) for finding in self._findings()) if self else []

    def _findings(self) -> Iterator[Finding]:
        if self._endless:
            yield from (endless(path, self.root) for path in self._endless)
            return
        by_name = {package.name: package for package in self.packages}
        plain = {package.name for package in self.packages if not self._is_for_ros(package)}
        yield from guarded(duplicate_faults, self.packages)
        yield from guarded(dependency_circle, self.packages)
        yield from guarded(taken_packages, self.packages)
        yield from guarded(layout_faults, self.root, self.packages, self.passed_over)
        started = [*guarded(self._started_faults)]
        told = {(finding.code, finding.place) for finding in started}
        order = BuildOrder(self.packages)
        # What looks for a file elsewhere than in its share folder tells itself that it is not there either.
        of_launch = (fault for file in self.launch_files for fault in file.faults)
        elsewhere = {("not-in-data-files", *f.about) for f in of_launch if f.code == "parameter-file-missing"}
        homes = homes_of(package for package in self.packages if package.name not in plain)
        for package in self.packages:
            is_plain = package.name in plain
            if not is_plain:
                of_manifest = _each_once(guarded(manifest_faults, package, by_name, plain, homes))
                yield from order.proposed(package, of_manifest)
            yield from guarded(interface_faults, package, self.interfaces, self.files)
            of_package = guarded(packaging_faults, package, is_for_ros=not is_plain, is_as_meant=True)
            yield from (f for f in of_package if (f.code, package.name, *f.about) not in elsewhere)
            yield from source_faults(self.sources(package), package.mains)
            yield from guarded(named_alike, self.sources(package), self._alternatives)
            yield from guarded(bare_imports, package, self.sources(package))
            yield from guarded(self._shadowed, package)
            of_files = guarded(self._file_faults, package)
            yield from (finding for finding in of_files if (finding.code, finding.place) not in told)
            yield from guarded(install_faults, self.root, package)
        yield from guarded(self._faults_of_launch_files, by_name)
        yield from guarded(self._topic_faults)
        yield from guarded(environment_apart, self._programs, self._partners)
        yield from guarded(self._service_faults, by_name)
        yield from guarded(lambda: passed_over(self.with_sources, self.launch_files))
        yield from started
        if self.environ is not None:
            yield from guarded(environment_faults, self.root, by_name, self.environ)

    @cached_property
    def _alternatives(self) -> set[frozenset[str]]:
        return alternatives(self.launch_files, self.packages)

    def _file_faults(self, package: SourcePackage) -> Iterator[Finding]:
        """Yield what is wrong with a package's parameter files."""
        launched = [node for file in self.launch_files for node in file.nodes if node.name is not None]
        names = {
            node.name if isinstance(node.name, str) else ""
            for node in launched
            if node.package == package.name
        }
        others = {node.name for node in launched if isinstance(node.name, str)} - names
        started = [node for file in self.launch_files for node in started_in(file, self.with_sources)]
        moved = {
            name
            for node in started
            if node.package is package
            for name, (source, _) in node.sources.node_names.items()
            if source.name == node.module and (node.name != name or node.namespace)
        }
        given = {pair for file in self.launch_files for node in file.nodes for pair in node.files}
        return file_faults(package, self.sources(package), names, moved, others, given=given)

    def _faults_of_launch_files(self, by_name: Mapping[str, SourcePackage]) -> Iterator[Finding]:
        homes = [package for package in self.packages for _ in package.launch_files]
        shared = Counter(package.name for package in self.packages)
        for file, home in zip(self.launch_files, homes, strict=True):
            # Of several packages with one name, a launch file means its own; which one others mean, nobody knows.
            meant = tuple(n for n in file.nodes if n.package == home.name or shared[n.package] < 2)
            known = {**self.executables, home.name: home.executables}
            yield from guarded(launch_faults, replace(file, nodes=meant), {**by_name, home.name: home}, known)

    def _topic_faults(self) -> Iterator[Finding]:
        ends = [end for package in self.packages for end in ends_of(self.sources(package), unnamed=True)]
        return topic_faults(
            [end for end in ends if not self._is_moved(end)], self._remapped(), self._partners
        )

    @property
    def _programs(self) -> list[Program]:
        """What the executables of the packages run."""
        points = [(self.sources(package), point) for package in self.packages for point in package.points]
        return [Program(own, p.module, p.function) for own, p in points if p.module in own.sources]

    def _is_moved(self, end: End) -> bool:
        """Return whether a launch file puts an end into a namespace in which it does not put the others."""
        spaces = self._spaces
        own = spaces.get((id(end.sources), end.creation.source.name), {""})
        are_alike = all(given == own for given in spaces.values())
        return not (end.is_absolute or own == {""} or are_alike)

    @cached_property
    def _spaces(self) -> Mapping[tuple[int, str], set[Any]]:
        """The namespaces in which launch files start the files of nodes."""
        found: dict[tuple[int, str], set[Any]] = {}
        for node in (node for file in self.launch_files for node in started_in(file, self.with_sources)):
            for module in node.sources.imported_by(node.module):
                found.setdefault((id(node.sources), module), set()).add(node.launched.namespace)
        return found

    @cached_property
    def _partners(self) -> Partners:
        """What else may have the other end of a topic or a service, and which packages are used together."""
        groups = [
            {node.sources for node in started_in(file, self.with_sources)} for file in self.launch_files
        ]
        groups += [
            {self.sources(package), self.sources(other)}
            for package in self.packages
            for other in self.packages
            if other.name in package.declared
        ]
        return Partners(OtherFiles(self.packages), groups)

    def _service_faults(self, names: Collection[str]) -> Iterator[Finding]:
        moved = {
            node.package.name for node in self.launched.values() if node.namespace or node.launched.remappings
        }
        # Turtlesim offers services of the types that everybody uses, such as /reset.
        users = (
            i.target
            for package in self.packages
            for source in package.sources.values()
            for i in source.imports
        )
        named = {*users, *(name for package in self.packages for name in package.declared)}
        is_alone = self._are_alone and not any(name.partition(".")[0] == "turtlesim" for name in named)
        ends = map(self.sources, self.packages)
        return service_faults(ends, names, moved | self._remapped(), self._partners, is_alone=is_alone)

    def _started_faults(self) -> Iterator[Finding]:
        started = [(file, path, started_in(file, self.with_sources)) for file, path in self.launches]
        # Where launch lacks a package, the text tells as much of a file in which nothing sets a namespace.
        known = [
            (file, nodes)
            for file, path, nodes in started
            if file.is_loaded or (file.lacks and "namespace" not in read_text(path).lower())
        ]
        yield from guarded(sections_apart, known)
        yield from guarded(set_back, [node for file, _, nodes in started if file.is_loaded for node in nodes])
        for launch_file, path, nodes in started:
            if launch_file.is_loaded:
                yield from guarded(self._faults_of_started, launch_file)
                yield from guarded(unknown_names, launch_file, nodes)
                yield from guarded(keyboard_faults, launch_file, nodes)
                yield from guarded(self.shared_names(launch_file, {}).faults)
                if path.suffix == ".py":
                    yield from guarded(awaited_ends, read_source(path, path.stem, launch_file.shown), nodes)

    def _faults_of_started(self, launch_file: LaunchFile) -> Iterator[Finding]:
        return started_faults(launch_file, self.with_sources, is_alone=self._are_alone)

    def shared_names(self, file: LaunchFile, seen: Mapping[str, Sequence[Name]]) -> SharedNames:
        """Return the nodes of a launch file with what tells which names they should share."""
        texts = [*(source.text for source in self.files), *map(read_text, self.launch_paths)]
        elsewhere = partial(self._partners.may_be_elsewhere, is_whole=True)
        nodes = started_in(file, self.with_sources)
        return SharedNames(file, nodes, self.with_sources, texts, elsewhere, seen)

    @cached_property
    def _are_alone(self) -> bool:
        return are_alone(self.launch_files, self.with_sources)

    def _is_for_ros(self, package: SourcePackage) -> bool:
        return is_for_ros(package, {node.package for file in self.launch_files for node in file.nodes})

    def _shadowed(self, package: SourcePackage) -> Iterator[Finding]:
        """Yield files and names that shadow an imported module or type, each once."""
        own = self.sources(package).sources
        # Python searches the folder of setup.py when it runs that, and the packages once they are installed.
        every = [*own.values(), *([package.setup.source] if package.setup else [])]
        found = (
            fault
            for source in every
            for fault in (*shadow_faults(source, package.folder, own), *hidden_types(source))
        )
        yield from {fault.cause: fault for fault in found}.values()

    def _remapped(self) -> set[str]:
        """Return the topics that launch files rename."""
        started = (node for file in self.launch_files for node in started_in(file, self.with_sources))
        ends = [end for node in started for end in node.ends]
        # A launch file that renames a node also renames each topic that begins with the node's name.
        below = {end.name for end, plain, _ in ends if end.is_private and plain != f"/{end.name}"}
        return below.union(*(node.remapped for file in self.launch_files for node in file.nodes))

    def package(self, name: str) -> SourcePackage | None:
        """Return the package of a name; None if there is none."""
        return next((package for package in self.packages if package.name == name), None)

    def sources(self, package: SourcePackage) -> NodeSources:
        """Return a package's Python files."""
        if package.folder not in self._sources:
            used = self._used if self.executables[package.name] is not None else set()
            made, written = partial(is_made, package), partial(written_modules, package)
            beyond = Beyond(
                self.modules, made, written, package.is_built_by_cmake, self._names, self.interfaces
            )
            self._sources[package.folder] = NodeSources(package.sources, used, beyond)
        return self._sources[package.folder]

    @cached_property
    def interfaces(self) -> dict[str, frozenset[str]]:
        """The names of the interfaces that the packages hold, by their modules, such as `my_robot.srv`."""
        files = [(package.name, path) for package in self.packages for path in package.own_files()]
        found = [
            (f"{name}{path.suffix}", path.stem)
            for name, path in files
            if path.suffix in (".msg", ".srv", ".action")
        ]
        return {home: frozenset(name for own, name in found if own == home) for home, _ in found}

    def sources_with(self, source: PythonSource) -> NodeSources:
        """Return the files of the package that has a file; the file alone if none has it."""
        home = next((own for own in self.packages if source in own.sources.values()), None)
        return self.sources(home) if home else NodeSources({source.name: source})

    @cached_property
    def _names(self) -> frozenset[str]:
        return frozenset(package.name for package in self.packages)

    @cached_property
    def modules(self) -> Mapping[str, PythonSource]:
        """The Python files of all packages, by the names of their modules."""
        return {name: source for package in self.packages for name, source in package.sources.items()}

    @cached_property
    def _used(self) -> set[str]:
        """What entry points, and imports across packages, name."""
        found = {main for package in self.packages for main in package.mains or ()}
        for package in self.packages:
            others = {
                name.partition(".")[0]
                for other in self.packages
                if other is not package
                for name in other.sources
            }
            targets = (imported.target for source in package.sources.values() for imported in source.imports)
            found |= {target for target in targets if target.partition(".")[0] in others}
        return found

    @cached_property
    def launch_files(self) -> list[LaunchFile]:
        """All launch files."""
        read = {
            path: read_launch_file(
                path, package.shown(str(path.relative_to(package.folder))), {*self.modules, *self._names}
            )
            for package in self.packages
            for path in package.launch_files
        }
        return load(read, self.packages) if self.loads else [*read.values()]

    @property
    def files(self) -> list[PythonSource]:
        """The Python files of all packages."""
        return [source for package in self.packages for source in package.sources.values()]

    @property
    def launches(self) -> list[tuple[LaunchFile, Path]]:
        """All launch files, each with its path."""
        return [*zip(self.launch_files, self.launch_paths, strict=True)]

    @property
    def launch_paths(self) -> list[Path]:
        """The paths of the launch files, in the same order as `launch_files`."""
        return [path for package in self.packages for path in package.launch_files]

    @cached_property
    def launched(self) -> dict[tuple[str, str], Started]:
        """How launch starts each executable, by package and name; the file with the most nodes wins."""
        files = sorted(
            (file for file in self.launch_files if file.is_loaded), key=lambda file: -len(file.nodes)
        )
        found: dict[tuple[str, str], Started] = {}
        for node in (node for file in files for node in started_in(file, self.with_sources)):
            found.setdefault((node.package.name, node.launched.executable), node)
        return found

    @cached_property
    def with_sources(self) -> dict[str, tuple[SourcePackage, NodeSources]]:
        """The packages by their names, each with its files."""
        return {package.name: (package, self.sources(package)) for package in self.packages}

    @cached_property
    def executables(self) -> Mapping[str, Collection[str] | None]:
        """The executables of each package; None for a package whose executables are not known.

        Of several packages with one name, which colcon refuses, any may be meant.
        """
        found: dict[str, list[str] | None] = {}
        for package in self.packages:
            before, names = found.get(package.name, []), package.executables
            is_known = before is not None and names is not None
            found[package.name] = [*dict.fromkeys([*(before or ()), *(names or ())])] if is_known else None
        return found


def _each_once(findings: Iterable[Finding]) -> Iterator[Finding]:
    """Yield what is wrong with a manifest; a package in a wrong tag, or imported and launched, is told once."""
    told: set[str] = set()
    for finding in findings:
        is_lacking = finding.code in ("dependency-undeclared", "dependency-launched")
        if finding.code == "dependency-joined" or is_lacking:
            if is_lacking and told.issuperset(finding.about):
                continue
            told.update(finding.about)
        yield finding
