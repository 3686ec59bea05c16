"""What was handed in: a clean copy, and what was found in it.

Nothing of a submission is run or imported. Receiving only copies; looking at the copy means parsing, which is
therefore done in a box (see `reader`).
"""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import Literal

from ros2lab import assignments
from ros2lab.assignments import Assignment
from ros2lab.diagnose.sources.file_texts import LARGEST_FILE as LARGEST_SOURCE
from ros2lab.diagnose.sources.interfaces import is_installed
from ros2lab.diagnose.sources.node_source import NODE_CLASSES
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, read_source, read_text
from ros2lab.grading.receiving.choice import Candidate, choose, why_not
from ros2lab.grading.receiving.clean_copy import HAND_IN, CleanCopy, Noted, SubmissionError, shown
from ros2lab.grading.receiving.made_files import note_made
from ros2lab.grading.receiving.notes import Kind, Note
from ros2lab.grading.receiving.repository_links import linked_members
from ros2lab.grading.receiving.unpacking import MANIFESTS, in_folder, unpack, unpack_inner

# How much of a submission is read; nobody writes more by hand.
MOST_PACKAGES = 50
MOST_SOURCE = 1_000_000  # bytes of Python

IGNORED = frozenset(("COLCON_IGNORE", "AMENT_IGNORE"))
_STARTS = NODE_CLASSES | {"rclpy.init", "rclpy.create_node"}

Form = Literal["workspace", "package", "files", "nothing"]


@dataclass(frozen=True)
class FoundPackage:
    """A package in a submission.

    Attributes:
        folder: the folder with its package.xml or setup.py.
        name: from package.xml, else from setup.py; None if neither has one.
        build_type: from package.xml; None if it has none or is not valid.
        error: a sentence that says why package.xml cannot be used; None if it can.
    """

    folder: str
    name: str | None
    build_type: str | None
    error: str | None


@dataclass(frozen=True)
class Submission:
    """What was found in a submission. Every path is relative to the unpacked folder, which itself is `.`.

    Attributes:
        form: `workspace` (the package lies below a src), `package`, `files` (only Python files with nodes), or
            `nothing` that could be graded.
        workspace: the folder whose src holds the assignment's package; None if there is none.
        packages: all packages, in the order of their folders.
        package: the assignment's package.
        node_files: Python files outside any package that start or define a node.
        notes: what was left out, refused or unpacked.
        also: other packages that colcon builds and that may play parts which the assignment's package does
            not: the work may be spread over several.
    """

    form: Form
    workspace: str | None
    packages: list[FoundPackage]
    package: FoundPackage | None
    node_files: list[str]
    notes: list[Note]
    also: list[FoundPackage] = field(default_factory=list)

    def noted(self, *kinds: Kind) -> list[str]:
        """Return the paths in the notes of these kinds."""
        return [path for note in self.notes if note.kind in kinds for path in note.paths]

    @property
    def left_unread(self) -> list[str]:
        """Sentences on the code that was received and passed over."""
        kinds = ("too large python", "too much python", "one of too many packages")
        return [str(note) for note in self.notes if note.kind in kinds]

    def worked_in(self) -> Submission:
        """Return it as a workspace in use, without notes on what builds leave beside src or Python leaves."""
        top = PurePosixPath(self.workspace or ".")
        notes = [
            note
            for note in self.notes
            if note.kind not in ("by a tool", "by a build", "made")
            or (note.kind == "by a build" and any(PurePosixPath(path).parent != top for path in note.paths))
        ]
        return replace(self, notes=notes)


@dataclass(frozen=True)
class Received:
    """A clean copy of what was handed in, before anything in it was read.

    Attributes:
        notes: what was left out, refused or unpacked.
        links: by link, its target, both relative to the copy.
    """

    notes: list[Note]
    links: dict[str, str]


def receive(path: Path, folder: Path, assignment: Assignment | None = None) -> Submission:
    """Copy or unpack what was handed in, and read it: `copied`, then `found_in`."""
    return found_in(folder.resolve(strict=True), copied(path, folder), assignment)


def copied(path: Path, folder: Path) -> Received:
    """Copy or unpack what was handed in.

    Args:
        path: a folder, a zip or a tar; it is never changed.
        folder: an empty folder that is not inside `path`; nothing is written anywhere else. Permissions are
            reduced to 644, or 755 for folders and programs.

    Raises:
        SubmissionError: if nothing can be received: the path does not exist, or is no archive, encrypted,
            broken, empty or beyond the limits. What was written by then stays in `folder`.
        ValueError: if `folder` is not empty or lies in `path`.
    """
    root, path = folder.resolve(strict=True), path.absolute()
    if any(root.iterdir()):
        raise ValueError(f"{folder} is not empty; give an empty folder.")
    if root.is_relative_to(os.path.realpath(path)):
        raise ValueError(f"{folder} lies in {path}, which is copied into it; give a folder outside.")
    copy = CleanCopy(root)
    if os.path.isdir(path):  # noqa: PTH112 -- False where pathlib raises
        followed = set[str]()
        for member, below in linked_members(path, copy.note):
            followed.add("/".join(below))
            copy.take([member], below)
        copy.take(member for member in in_folder(path, copy.note) if member.name not in followed)
    else:
        unpack(path, copy)
    copy.remove_built()
    unpack_inner(copy)
    note_made(copy)
    links = copy.make_links()
    if not _files_in(root):
        why = "; ".join(str(note).rstrip(".") for note in copy.notes)
        found = f"holds nothing to grade ({why})" if why else "is empty"
        raise SubmissionError(f"{shown(path.name)} {found}; {HAND_IN}.")
    return Received(
        copy.notes, {str(link.relative_to(root)): str(end.relative_to(root)) for link, end in links.items()}
    )


def found_in(root: Path, received: Received, assignment: Assignment | None = None) -> Submission:
    """Read a received submission.

    Args:
        root: the folder with the copy.
        received: the notes and links of the copy.
        assignment: the assignment for which it was handed in; None takes the course's own.
    """
    assignment, noted, files = assignment or assignments.load(), Noted(), _files_in(root)
    links = {root / link: root / end for link, end in received.links.items()}
    folders = _package_folders(files, noted)
    packages = {folder: _package(root, folder) for folder in folders}
    # A package whose package.xml cannot be read is none for colcon, which then searches its folders.
    seen = {folder for folder in folders if packages[folder].error is None or folder / "setup.py" in files}
    built = {folder for folder in folders if _is_built(root, packages[folder], seen)}
    for folder in folders:
        if seen.intersection(folder.parents):
            noted.note("in another package", str(folder))
    sources = _by_package(_sources(root, files, noted, assignment), folders, built)
    candidates = [
        Candidate(
            folder,
            packages[folder].name or folder.name,
            folder in built,
            _workspace(root, folder, links),
            sources.get(folder, []),
            assignment,
        )
        for folder in folders
    ]
    chosen, also = choose(candidates)
    _note_others(candidates, chosen, also, noted)
    for candidate in candidates:
        if candidate not in (chosen, *also) and candidate.folder in seen and is_installed(candidate.name):
            noted.note("for a library", str(candidate.folder))
    node_files = [source.shown for source in sources.get(None, []) if _starts_node(source)]
    workspace = chosen.workspace if chosen else None
    form: Form = "workspace" if workspace else "package" if chosen else "files" if node_files else "nothing"
    return Submission(
        form,
        workspace,
        [*packages.values()],
        packages[chosen.folder] if chosen else None,
        node_files,
        [*received.notes, *noted.notes],
        [packages[candidate.folder] for candidate in also],
    )


def _by_package(
    sources: Iterable[PythonSource], folders: Sequence[PurePosixPath], built: Collection[PurePosixPath]
) -> dict[PurePosixPath | None, list[PythonSource]]:
    """Return sources by the folder of their package; None for those outside any package."""
    found: dict[PurePosixPath | None, list[PythonSource]] = {}
    for source in sources:
        around = [folder for folder in folders if folder in PurePosixPath(source.shown).parents]
        innermost = max(around, key=lambda folder: len(folder.parts), default=None)
        # A source in a package that colcon does not see also belongs to the package around it.
        for owner in {innermost, *set(built).intersection(around)}:
            found.setdefault(owner, []).append(source)
    return found


def _note_others(
    candidates: Sequence[Candidate], chosen: Candidate | None, also: Sequence[Candidate], noted: Noted
) -> None:
    """Note why each other package with sources of nodes is not graded."""
    for candidate in candidates:
        if chosen and candidate.sources and candidate is not chosen and candidate not in also:
            noted.note(why_not(candidate, chosen), str(candidate.folder), shown(str(chosen.folder)))


def _files_in(root: Path) -> list[PurePosixPath]:
    return sorted(
        PurePosixPath(parent, name).relative_to(root.as_posix())
        for parent, _, names in os.walk(root)
        for name in names
    )


def _package_folders(files: Iterable[PurePosixPath], noted: Noted) -> list[PurePosixPath]:
    """Return the folders with a package.xml, or with a setup.py outside of any such folder."""
    files = [*files]
    ignored = {file.parent for file in files if file.name in IGNORED}
    for folder in sorted(ignored):
        noted.note("ignored by colcon", str(folder))
    seen = [file for file in files if not ignored.intersection(file.parents)]
    if not any(file.name in MANIFESTS for file in seen):
        seen = files  # packages that colcon does not see are better than none
    manifests = {file.parent for file in seen if file.name == "package.xml"}
    scripts = {file.parent for file in seen if file.name == "setup.py"}
    found = manifests | {folder for folder in scripts if not manifests.intersection(folder.parents)}
    highest = sorted(found, key=lambda folder: (len(folder.parts), folder))
    for folder in highest[MOST_PACKAGES:]:
        noted.note("one of too many packages", str(folder), MOST_PACKAGES)
    return sorted(highest[:MOST_PACKAGES])


def _package(root: Path, folder: PurePosixPath) -> FoundPackage:
    source = SourcePackage(root / folder, root)
    error = _manifest_error(source)
    name = build_type = None
    if error is None:
        name, build_type = str(source.manifest.name), source.build_type
    elif source.setup is not None:
        name = source.setup.keywords.get("name")
    return FoundPackage(str(folder), name if isinstance(name, str) else None, build_type, error)


def _manifest_error(source: SourcePackage) -> str | None:
    if not source.has("package.xml"):
        return "There is no package.xml beside setup.py."
    if "<!ENTITY" in read_text(source.folder / "package.xml"):
        # A few entities can expand to gigabytes.
        return "package.xml is not valid: it defines entities, which no package.xml needs."
    if source.manifest is None:
        return f"package.xml is not valid: {shown(source.manifest_fault or '', 300).rstrip('.')}."
    return None


def _sources(
    root: Path, files: Iterable[PurePosixPath], noted: Noted, assignment: Assignment
) -> Iterator[PythonSource]:
    """Yield the Python files that mention ROS or the assignment's topics, those in higher folders first."""
    words = re.compile("|".join(["rclpy", *(topic.rpartition("/")[2] for topic in assignment.topics)]))
    budget = MOST_SOURCE
    scripts = [file for file in files if file.suffix == ".py" and file.name != "setup.py"]
    for file in sorted(scripts, key=lambda file: (len(file.parts), file)):
        source = read_source(root / file, file.stem, str(file))
        if words.search(source.text):
            budget -= len(source.text)
            if budget < 0:
                noted.note("too much python", str(file), MOST_SOURCE)
            else:
                yield source
        elif (root / file).stat().st_size > LARGEST_SOURCE:
            noted.note("too large python", str(file), LARGEST_SOURCE)


def _is_built(root: Path, package: FoundPackage, seen: Collection[PurePosixPath]) -> bool:
    """Return whether colcon sees a package, and builds its executables as ament_python."""
    is_seen = not any(folder in PurePosixPath(package.folder).parents for folder in seen)
    if not is_seen or package.build_type != "ament_python":
        return False
    script = SourcePackage(root / package.folder, root).setup
    return script is not None and script.entry_points != []


def _workspace(root: Path, folder: PurePosixPath, links: Mapping[Path, Path]) -> str | None:
    """Return the folder whose src holds a package, at any depth or through a link; None if there is none."""
    there = root / folder
    by_link = [
        (link / there.relative_to(end)).relative_to(root)
        for link, end in links.items()
        if there.is_relative_to(end)
    ]
    for path in [folder, *map(PurePosixPath, sorted(by_link))]:
        sources = [parent for parent in (path, *path.parents) if parent.name == "src"]
        if sources:
            return str(sources[0].parent)
    return None


def _starts_node(source: PythonSource) -> bool:
    """Return whether a file defines a node or starts ROS; an unparsable one only has to import rclpy."""
    targets = {imported.target for imported in source.imports}
    if source.fault:
        return re.search(r"^\s*(import|from)\s+rclpy\b", source.text, re.MULTILINE) is not None
    used = [base for node in source.nodes if isinstance(node, ast.ClassDef) for base in node.bases]
    used += [node.func for node in source.nodes if isinstance(node, ast.Call)]
    return not targets.isdisjoint(("rclpy.*", "rclpy.node.*")) or any(
        source.resolve(expression) in _STARTS for expression in used
    )
