"""The facts in a submission's files, found by parsing, never by running or importing.

`diagnose` finds what is wrong with a package, so that a lost point and the advice on it have the same source.
If a value is known only when setup.py runs, the fact counts as true; the build shows whether it is.
"""

from __future__ import annotations

import ast
import itertools
import os
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache, cached_property
from pathlib import Path, PurePosixPath
from typing import Any

from ros2lab import assignments
from ros2lab.assignments import Assignment
from ros2lab.diagnose.code.syntax_repairs import mended
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.parameter_faults import declared_in
from ros2lab.diagnose.rules import text_faults
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.parameter_file import ParameterFileError, read_parameter_file
from ros2lab.diagnose.sources.python_source import PythonSource, read_source, read_text
from ros2lab.grading.code.branches import branches
from ros2lab.grading.code.compared import compared, contents_of
from ros2lab.grading.code.dependence import depended_on
from ros2lab.grading.code.running import Code, idle, running
from ros2lab.grading.code.vain_handlers import VainHandlers
from ros2lab.grading.evidence import Files, Place, WrittenEnd
from ros2lab.grading.reading.described import described
from ros2lab.grading.reading.diagnosed import all_corrected, diagnosed, findings_of, in_evidence
from ros2lab.grading.reading.documents import foreign_names, named_in, readmes, recordings, unrendered
from ros2lab.grading.reading.graded_package import Package, has_code
from ros2lab.grading.reading.launch_files import (
    around,
    hard_coded,
    lacks,
    launch_files,
    launching,
    packages_named,
    programs_named,
    programs_of,
    those_that_start_most_first,
    uncommented,
    without_comments,
)
from ros2lab.grading.reading.package_facts import manifest_facts, setup_facts
from ros2lab.grading.reading.tests_handed_in import test_files, tests_of
from ros2lab.grading.reading.unread import OF_CODE, OF_EACH_FILE, Tell, is_open, legible, read_all, told
from ros2lab.grading.reading.written_ends import ends_elsewhere, ends_left, written_ends
from ros2lab.grading.receiving.submission import Submission
from ros2lab.handlers import Handlers

MOST_DECLARED = 50  # parameters
_Ends = tuple[list[WrittenEnd], list[WrittenEnd]]


def look(
    root: Path,
    submission: Submission,
    assignment: Assignment | None = None,
    tell: Tell = lambda _name, _value: None,
) -> Files:
    """Collect the facts in a submission's files.

    Args:
        root: the folder that holds the submission.
        submission: what was found there.
        assignment: the submission's assignment; None takes the course's own.
        tell: given the name and the value of each fact as soon as it is known.

    Returns:
        The facts; those that only a run can show are left empty. Paths are relative to `root`.
    """
    found = submission.package
    assignment = assignment or assignments.load()
    words = assignment.commanded.commands if assignment.commanded else ()
    paths = _paths(root)
    beside = launching(root, submission)
    texts, shown = readmes(root, paths, submission, beside), recordings(root, paths)
    foreign = foreign_names(texts, root, paths)
    for name, value in (("readme", texts), ("readme_foreign", foreign), ("recordings", shown)):
        tell(name, value)
    if found is None:
        return replace(
            _loose(root, submission, paths, texts, words), readme_foreign=foreign, recordings=shown
        )
    reader = _PackageReader(root, submission, assignment, paths)
    facts, unread = read_all(reader.readers(texts), tell)
    unread |= _unread(_beyond(reader.graded), reader.sources)
    notes = [*facts.pop("left_out", {}).values(), *told(unread), *unrendered(paths)]
    return Files(**facts, readme=texts, readme_foreign=foreign, recordings=shown, notes=notes, unread=unread)


def ends_meant(
    root: Path, found: Submission, asked: Assignment, findings: Iterable[Finding]
) -> list[WrittenEnd]:
    """Return `Files.ends_meant` of a submission with a package by other findings."""
    return _PackageReader(root, found, asked, ()).meant(findings)


def _unread(why: str, read: Iterable[PythonSource]) -> dict[str, str]:
    """Return the facts that code which was not read leaves open, with the reason: not those that other code has told."""
    is_told = any(map(has_code, read))
    return {name: why for name in OF_CODE if why and not (is_told and name in OF_EACH_FILE)}


def _beyond(packages: Iterable[Package]) -> str:
    """Return which files of some packages are too large or too deep to be followed here, as sentences; empty if none is."""
    found, notes = [], list[str]()
    for package in packages:
        tests = [package.read(path, path.stem) for path in test_files(package)]
        found += [source.shown for source in legible((*package.own_sources, *tests)) if is_open(source)]
        notes += package.notes
    deep = [f"{', '.join(found)}: the code is nested too deeply for the grader to follow."] if found else []
    return " ".join([*notes, *deep])


class _PackageReader:
    """Reads the facts of packages."""

    def __init__(
        self, root: Path, submission: Submission, assignment: Assignment, paths: Sequence[PurePosixPath]
    ) -> None:
        assert submission.package is not None
        self.root, self.submission, self.assignment, self.paths = root, submission, assignment, paths
        self.words = assignment.commanded.commands if assignment.commanded else ()
        self.package = Package(root / submission.package.folder, root)
        self.graded = [self.package, *(Package(root / other.folder, root) for other in submission.also)]
        beside = [other for other in launching(root, submission) if other not in submission.also]
        self.packages = [*self.graded, *(Package(root / other.folder, root) for other in beside)]

    def readers(self, texts: str) -> dict[str, Callable[[], Any]]:
        """Return a reader for each fact by its name in `Files`, and one for notes on omitted tests."""
        root, packages, graded = self.root, self.packages, self.graded
        names = {found.name for found in self.submission.packages if found.name}
        every = [Package(root / found.folder, root) for found in self.submission.packages]
        return {
            "manifest": lambda: manifest_facts(self.package, names, self.assignment.dependencies),
            "setup": lambda: setup_facts(self.package),
            "sources": lambda: described(self.sources, self.code, texts),
            "sources_beside": lambda: {
                package.name: described(own, self.code, texts)
                for package, own in zip(graded[1:], self._sources[1:], strict=True)
            },
            "readme_names": lambda: named_in(texts, self.sources),
            "launch_files": lambda: self._shown(self.launches),
            "launch_lacks": lambda: lacks(root, texts, self.launches),
            "launched_packages": lambda: {
                str(path.relative_to(root)): sorted(packages_named(path, text, names))
                for path, text in self.launches.items()
            },
            "launched_programs": lambda: {
                str(path.relative_to(root)): named
                for path, named in programs_named(self.launches, programs_of(self.graded)).items()
            },
            "launch_files_elsewhere": lambda: self._shown(
                path for path in launch_files(every) if path not in self.launches
            ),
            "parameter_files": lambda: {
                str(path.relative_to(root)): _parameters(read_text(path))
                for path in _parameter_files(packages)
            },
            "parameter_file_users": lambda: _parameter_file_users(root, packages),
            "hard_coded": lambda: hard_coded(packages),
            "tests": lambda: self._tests[0],
            "tests_left_out": lambda: [*self._tests[1]],
            "left_out": lambda: self._tests[1],
            "handlers": lambda: _handlers(_of_nodes(self.sources), self.code),
            "compared": lambda: compared(node for _, node in self.mended_code),
            "depended_on": lambda: depended_on(self.mended, self.mended_code),
            "branches": lambda: branches(self.mended, self.mended_code, self.words, self.findings),
            "idle": lambda: idle(self.sources, self.code),
            "ends": lambda: self.ends[0],
            "ends_elsewhere": lambda: ends_elsewhere(
                root, self.paths, self.sources, itertools.chain(*self.ends)
            ),
            "contents": lambda: contents_of(self.mended),
            "declared": lambda: {
                name: value for package in reversed(graded) for name, value in _declared(package).items()
            },
            "findings": lambda: in_evidence(self.findings),
            "ends_meant": lambda: self.meant(self.findings),
            "ends_left": lambda: ends_left(
                self.ends[0], self.findings, lambda vain: self._ends_in(self.mended, vain)[0]
            ),
        }

    @cached_property
    def sources(self) -> list[PythonSource]:
        return [source for own in self._sources for source in own]

    @cached_property
    def _sources(self) -> list[list[PythonSource]]:
        """The sources of each graded package."""
        return [legible(package.own_sources) for package in self.graded]

    @cached_property
    def launches(self) -> dict[Path, str]:
        texts = uncommented([*self.packages, *around(self.package, self.root)])
        return those_that_start_most_first(texts, programs_named(texts, programs_of(self.graded)))

    @cached_property
    def entrances(self) -> set[str] | None:
        return _entrances(self.graded)

    @cached_property
    def code(self) -> Code:
        return [*running(self.sources, self.entrances)]

    @cached_property
    def mended(self) -> list[PythonSource]:
        """The sources with slips of typing undone: what a file plainly has counts, also where Python cannot read it."""
        return [*map(mended, self.sources)]

    @cached_property
    def mended_code(self) -> Code:
        return [*running(self.mended, self.entrances)]

    @cached_property
    def ends(self) -> _Ends:
        return self._ends_in(self.mended)

    def meant(self, findings: Iterable[Finding]) -> list[WrittenEnd]:
        return self._ends_in(all_corrected(self.mended, findings))[0]

    @cached_property
    def findings(self) -> list[Finding]:
        return findings_of(self.root, self.submission, self.graded)

    def _ends_in(self, sources: Sequence[PythonSource], vain: Collection[str] = ()) -> _Ends:
        return written_ends(sources, self.entrances, self.words, vain)

    @cached_property
    def _tests(self) -> tuple[dict[str, int], dict[str, str]]:
        return tests_of(self.package)

    def _shown(self, paths: Iterable[Path]) -> list[str]:
        return [str(path.relative_to(self.root)) for path in paths]


def _loose(
    root: Path,
    submission: Submission,
    paths: Iterable[PurePosixPath],
    texts: str,
    words: Collection[str],
) -> Files:
    """Return the facts in files outside a package."""
    paths_of_nodes = ((root / name, PurePosixPath(name).stem, name) for name in submission.node_files)
    loose = legible([read_source(*named) for named in paths_of_nodes])
    whole = cache(lambda: [*map(mended, loose)])
    ends = cache(lambda: written_ends(whole(), words=words)[0])
    findings = cache(lambda: diagnosed(lambda: [found for source in loose for found in text_faults(source)]))
    readers: dict[str, Callable[[], Any]] = {
        "sources": lambda: described(loose, [*running(loose)], texts),
        "readme_names": lambda: named_in(texts, loose),
        "handlers": lambda: _handlers(loose, [*running(loose)]),
        "compared": lambda: compared(node for _, node in running(whole())),
        "depended_on": lambda: depended_on(whole(), [*running(whole())]),
        "branches": lambda: branches(whole(), [*running(whole())], words, findings()),
        "contents": lambda: contents_of(whole()),
        "ends": ends,
        "ends_left": lambda: ends_left(
            ends(), findings(), lambda vain: written_ends(whole(), words=words, vain=vain)[0]
        ),
        "ends_elsewhere": lambda: ends_elsewhere(
            root, paths, loose, itertools.chain(*written_ends(loose, words=words))
        ),
        "findings": lambda: in_evidence(findings()),
        "ends_meant": lambda: written_ends(all_corrected(whole(), findings()), words=words)[0],
    }
    facts, unread = read_all(readers)
    unread |= _unread(" ".join(submission.left_unread), loose)
    return Files(**facts, readme=texts, notes=told(unread), unread=unread)


def _paths(root: Path) -> list[PurePosixPath]:
    """Return all files below a folder, relative to it."""
    return [
        PurePosixPath(parent, name).relative_to(root.as_posix())
        for parent, _, names in os.walk(root)
        for name in names
    ]


def _of_nodes(sources: Collection[PythonSource]) -> list[PythonSource]:
    """Return the modules of nodes: those that import rclpy, also through others, and those that these import."""
    found = [source for source in sources if _imports(source, "rclpy")]
    for source in found:
        name = source.name.rpartition(".")[2]
        found += [other for other in sources if other not in found and _imports(other, name)]
    for source in found:
        found += [
            other
            for other in sources
            if other not in found and _imports(source, other.name.rpartition(".")[2])
        ]
    return found


def _imports(source: PythonSource, name: str) -> bool:
    """Return whether a module imports a module of this name, or something from it."""
    return any(name in found.target.split(".") for found in source.imports)


def _entrances(packages: Iterable[Package]) -> set[str] | None:
    """Return the functions that entry points name; None if they are not known."""
    found = set[str]()
    for package in packages:
        points = package.setup.entry_points if package.setup else None
        if not points:
            return None
        found |= {point.function for point in points}
    return found


def _handlers(sources: Collection[PythonSource], code: Code) -> dict[str, list[Place]]:
    places: dict[str, list[Place]] = {"by name": [], "wholesale": [], "of an end": []}
    known = {source.name: Handlers(source.nodes) for source in sources}
    vain = VainHandlers(node for source in sources for node in source.nodes)
    handled = {
        handler
        for source in sources
        for node in source.nodes
        if isinstance(node, ast.Try)
        for handler in {*node.handlers}.difference(vain.of(node, known[source.name]))
    }
    for source, node in code:
        if isinstance(node, ast.ExceptHandler) and node in handled:
            of_file = known[source.name]
            if of_file.only_raises_again(node):
                continue
            key = (
                "of an end"
                if of_file.is_of_an_end(node)
                else "by name"
                if of_file.is_by_name(node)
                else "wholesale"
            )
            places[key].append(Place(source.shown, node.lineno))
    return {key: sorted(found, key=lambda place: (place.file, place.line)) for key, found in places.items()}


def _parameter_files(packages: Iterable[Package]) -> list[Path]:
    """Return the files that set parameters, or lie where such files are expected."""
    found: list[Path] = []
    for package in packages:
        paths = [path for path in package.folder.rglob("*.y*ml") if path.is_file()]
        found += sorted(
            {path for path in paths if "ros__parameters" in read_text(path)}.union(package.parameter_files)
        )
    return found


def _parameter_file_users(root: Path, packages: Sequence[Package]) -> dict[str, list[str]]:
    """Return the launch files, and the modules that read YAML, that name each parameter file."""
    texts = {str(path.relative_to(root)): text for path, text in uncommented(packages).items()}
    for source in packages[0].own_sources:
        if any(found.target.partition(".")[0] == "yaml" for found in source.imports):
            texts[source.shown] = without_comments(source.text)
    return {
        str(path.relative_to(root)): [name for name, text in texts.items() if path.name in text]
        for path in _parameter_files(packages)
    }


def _parameters(text: str) -> dict[str, dict[str, Any]]:
    """Return the parameters in a file, by node; empty if the file cannot be read or repeats itself."""
    try:
        root = read_parameter_file(text)
    except ParameterFileError:
        return {}
    found: dict[str, dict[str, Any]] = {}
    queue = [("", root)]
    while queue:
        name, value = queue.pop()
        for key, inner in value.items() if isinstance(value, dict) else ():
            if key == "ros__parameters":
                found[name or "/"] = {str(parameter): held for parameter, held in _flat("", inner)}
            else:
                queue.append((f"{name}/{str(key).strip('/')}", inner))
    return found


def _flat(prefix: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Yield parameters by their full names, with a dot after each group."""
    for key, inner in value.items() if isinstance(value, dict) else ():
        if isinstance(inner, dict):
            yield from _flat(f"{prefix}{key}.", inner)
        elif isinstance(inner, (str, bool, int, float)):
            yield f"{prefix}{key}", inner
        else:
            yield f"{prefix}{key}", str(inner)


def _declared(package: Package) -> dict[str, bool | float | str | None]:
    """Return the parameters that a package's nodes declare, as far as they are known."""
    try:
        found = declared_in(NodeSources(package.sources)) or {}
    except RecursionError:
        return {}
    plain = {
        name: value if isinstance(value, (bool, int, float, str)) else None for name, value in found.items()
    }
    return dict(itertools.islice(plain.items(), MOST_DECLARED))
