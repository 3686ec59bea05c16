"""The clean copy of a submission, while it is written.

Bytes, files and paths are counted as they are written. Links are made last, so that there are none to follow
while files are written, and only if they lead to something inside the copy.
"""

from __future__ import annotations

import os
import re
import shutil
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Literal

from ros2lab.grading.receiving.notes import MOST_KEPT, Kind, Note

# What a submission may hold. Too long files and paths are left out; past any other limit, it is refused.
MOST_BYTES = 500_000_000
MOST_MEMBERS = 30_000  # files, folders and links
MOST_LINKS = 1000
MOST_CPU = 100.0  # s, to unpack it
LARGEST_FILE = 50_000_000  # bytes
LONGEST_PATH = 1000  # bytes
DEEPEST_FOLDER = 40

HAND_IN = "hand in the workspace as a folder, a .zip or a .tar.gz"
CHUNK = 1 << 16  # bytes
_MOST_LINKS_IN_A_ROW = 20  # Linux follows 40


# The same as in hand_in, which needs ROS and takes 0.5 s to import.
_BUILT = ("build", "install", "log")
TOOLS_NAMES = re.compile(
    r"\.git|\.hg|\.svn|\.venv|venv|node_modules|\.tox|\.(mypy|pytest|ruff)_cache|\.ipynb_checkpoints"
    r"|__pycache__|.*\.py[co]|.*\.egg-info|\.idea|\.vscode|__MACOSX|\._.*|\.DS_Store|Thumbs\.db|desktop\.ini",
    re.DOTALL,
)
# What colcon leaves in build, install and log.
_COLCONS = frozenset(
    (
        "COLCON_IGNORE",
        "setup.bash",
        "local_setup.bash",
        ".colcon_install_layout",
        ".built_by",
        "colcon_build.rc",
    )
) | {"events.log", "logger_all.log", "build", "share"}
_SETUPS = re.compile(r"(?:lib|bdist|temp|scripts)\b")  # what setup.py leaves in build
# Files that only a build leaves in a package's folder, even where that holds a copy of all sources.
_COPIES = ({"colcon_build.rc"}, {"colcon_command_prefix_setup_py.sh"})
# Files that only a build leaves together in any folder. COLCON_IGNORE is not: people make it by hand, too.
_MARKS = (
    *_COPIES,
    {".built_by"},
    {".colcon_install_layout"},
    {"local_setup.bash", "_local_setup_util_sh.py"},
    {"events.log", "logger_all.log"},  # of a run of colcon
    {"stdout_stderr.log", "command.log"},  # of one package in it
    {"METADATA", "RECORD"},  # of what was installed by Python
)


def opened(path: Path | str, folder: int | None = None) -> BinaryIO:
    """Open a file that somebody else may change meanwhile, without following a link or waiting for a pipe.

    Args:
        path: the file's path.
        folder: a descriptor of the folder that the path starts from; None for the working folder.
    """
    flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK
    return os.fdopen(os.open(path, flags, dir_fd=folder), "rb")


class SubmissionError(Exception):
    """The submission cannot be received; the text says what was found, and what to hand in."""


class BeyondLimitsError(SubmissionError):
    """The submission holds more than it may."""


class Meter:
    """Counts bytes, and the CPU time spent on them, up to a limit."""

    def __init__(self) -> None:
        self._bytes = 0
        self._start = time.process_time()

    def add(self, count: int) -> None:
        """Count this many more bytes; BeyondLimitsError if that is too much."""
        self._bytes += count
        if self._bytes > MOST_BYTES:
            raise BeyondLimitsError(
                f"The submission holds more than {MOST_BYTES / 1e6:g} MB; hand in only what you have written."
            )
        if time.process_time() - self._start > MOST_CPU:
            raise BeyondLimitsError(
                f"To unpack the submission takes more than {MOST_CPU:g} s of CPU time; pack it with `zip`."
            )


@dataclass(frozen=True)
class Member:
    """A file, with its `data`, a link, with its `target`, or a folder of a submission."""

    name: str
    kind: Literal["file", "folder", "link", "hard link", "other"]
    data: BinaryIO | None = None
    target: str = ""
    is_executable: bool = False


class Noted:
    """Notes on the members of a submission."""

    def __init__(self) -> None:
        self._noted: dict[tuple[Kind, str], dict[str, None]] = {}

    def note(self, kind: Kind, name: str, detail: object = "") -> None:
        """Note what was done with a member, and why."""
        self._noted.setdefault((kind, str(detail)), {})[shown(name)] = None

    @property
    def notes(self) -> list[Note]:
        """The notes, one for each kind and detail."""
        return [
            Note(kind, [*names][:MOST_KEPT], detail, len(names))
            for (kind, detail), names in self._noted.items()
        ]


class CleanCopy(Noted):
    """The clean copy while it is written."""

    def __init__(self, root: Path) -> None:
        super().__init__()
        self.root = root
        self.unpacked = Meter()  # what comes out of compressed tars, kept or not
        self._written = Meter()
        self._members = 0
        self._links: dict[Path, str] = {}

    def take(self, members: Iterable[Member], below: tuple[str, ...] = ()) -> None:
        """Write the members below a folder of the copy; of two with the same name, the later one stays."""
        for member in members:
            self._count()
            own = tuple(part for part in member.name.split("/") if part not in ("", "."))
            by_tool = next((n for n, part in enumerate(own, 1) if TOOLS_NAMES.fullmatch(part)), None)
            if by_tool is not None:
                self.note("by a tool", "/".join((*below, *own[:by_tool])))
            elif reason := _path_fault(member.name, (*below, *own)):
                self.note(reason, member.name)
            elif own:
                self._take(member, self.root.joinpath(*below, *own), below)

    def _take(self, member: Member, path: Path, below: tuple[str, ...]) -> None:
        if member.kind == "other":
            self.note("no file", member.name)
            return
        if not self._make_folder(path if member.kind == "folder" else path.parent):
            self.note("name taken", member.name)
            return
        if not _is_unicode(member.name):
            self.note("not unicode", member.name)
        if member.kind == "link":
            self._links[path] = member.target
        elif member.kind == "hard link":
            self._copy_inside(member, path, below)
        elif member.data is not None:
            self._write(member, path, member.data)

    def _copy_inside(self, member: Member, path: Path, below: tuple[str, ...]) -> None:
        if reason := _path_fault(member.target, (*below, *member.target.split("/"))):
            self.note(reason, f"{member.name} -> {member.target}")
            return
        source = self.root.joinpath(*below, member.target)
        if not source.is_file():
            self.note("no target", f"{member.name} -> {member.target}")
            return
        with source.open("rb") as data:
            self._write(member, path, data)

    def _write(self, member: Member, path: Path, data: BinaryIO) -> None:
        if path.is_dir():
            self.note("name taken", member.name)
            return
        path.unlink(missing_ok=True)
        size = 0
        with path.open("xb") as file:
            while size <= LARGEST_FILE and (chunk := data.read(CHUNK)):
                size += len(chunk)
                self._written.add(len(chunk))
                file.write(chunk)
        path.chmod(0o755 if member.is_executable else 0o644)
        if size > LARGEST_FILE:
            path.unlink()
            self.note("too large", member.name, f"{LARGEST_FILE / 1e6:g} MB")

    def _make_folder(self, path: Path) -> bool:
        """Make a folder and its parents; return False if a file is in the way."""
        if path.is_dir():
            return True
        if path.exists() or not self._make_folder(path.parent):
            return False
        self._count()
        path.mkdir()
        path.chmod(0o755)
        return True

    def _count(self) -> None:
        self._members += 1
        if self._members > MOST_MEMBERS:
            raise BeyondLimitsError(
                f"The submission holds more than {MOST_MEMBERS} files and folders; "
                "hand in only what you have written."
            )

    def remove_built(self) -> None:
        """Remove what colcon and setuptools made, whatever its name, and virtual environments."""
        for parent, folders, files in os.walk(self.root):
            beside = {*folders, *files}
            for name in sorted(folders):
                path = Path(parent, name)
                is_built = (name in _BUILT and _is_built(path, beside)) or _is_marked(path)
                if is_built or (path / "pyvenv.cfg").exists():
                    shutil.rmtree(path)
                    folders.remove(name)
                    self.note("by a build" if is_built else "by a tool", str(path.relative_to(self.root)))

    def make_links(self) -> dict[Path, Path]:
        """Make the links that lead to something in the copy without leaving it on the way.

        Returns:
            Where each link leads.
        """
        links = {path: target for path, target in self._links.items() if path.parent.is_dir()}
        for path in [path for path in links if path.exists()]:
            self._note_link("name taken", path, links.pop(path))
        if len(links) > MOST_LINKS:
            raise BeyondLimitsError(f"The submission holds more than {MOST_LINKS} links; {HAND_IN}.")
        made = {}
        for path, end in _ends(self.root, links).items():
            if isinstance(end, Path):
                path.symlink_to(links[path])
                made[path] = end
            else:
                self._note_link(end, path, links[path])
        return made

    def _note_link(self, kind: Kind, path: Path, target: str) -> None:
        self.note(kind, f"{path.relative_to(self.root)} -> {target}")


def _ends(root: Path, links: Mapping[Path, str]) -> dict[Path, Path | Kind]:
    """Return where each link would lead: a path in the root, or the reason why it cannot be made."""
    ends: dict[Path, Path | Kind] = {}

    def follow(link: Path, depth: int) -> Path | Kind:
        target = links[link]
        if link in ends:
            pass
        elif target.startswith("/"):
            ends[link] = "outside"
        elif not target or "\0" in target or depth > _MOST_LINKS_IN_A_ROW or is_too_long(target.split("/")):
            ends[link] = "no target"
        else:
            ends[link] = walk(link.parent, target.split("/"), depth)
        return ends[link]

    def walk(here: Path, parts: Sequence[str], depth: int) -> Path | Kind:
        for part in parts:
            if not here.is_dir():
                return "no target"
            if part == "..":
                if here == root:
                    return "outside"
                here = here.parent
            elif part not in ("", "."):
                here /= part
                end = follow(here, depth + 1) if here in links else here
                if isinstance(end, str):
                    return end
                here = end
        return here if here.exists() else "no target"

    for link in links:
        follow(link, 0)
    return ends


def _path_fault(name: str, parts: tuple[str, ...]) -> Kind | None:
    """Return why a member of this name cannot be written; `parts` is its whole path. None if it can."""
    if name.startswith("/") or ".." in name.split("/") or "\0" in name:
        return "outside"
    return "path too long" if is_too_long(parts) else None


def is_too_long(parts: Sequence[str]) -> bool:
    """Return whether a path, or a name in it, is too long to be received."""
    lengths = [len(os.fsencode(part)) for part in parts]
    return len(parts) > DEEPEST_FOLDER or sum(lengths) > LONGEST_PATH or max(lengths, default=0) > 255


def _is_built(folder: Path, beside: set[str]) -> bool:
    """Return whether colcon or setup.py made a folder, judged by the names in it and in its folders."""
    inside = {path.name for path in folder.iterdir()}
    if "package.xml" in inside:
        return False
    is_by_setup = folder.name == "build" and "setup.py" in beside
    inner = {path.name for path in folder.glob("*/*")}
    return (is_by_setup and all(map(_SETUPS.match, inside))) or not _COLCONS.isdisjoint(inside | inner)


def _is_marked(folder: Path) -> bool:
    """Return whether a folder, or each folder in it, has the marks of a build, and no sources lie there."""
    inside = {path.name: path.is_dir() for path in folder.iterdir()}
    folders = [folder / name for name, is_folder in inside.items() if is_folder]
    is_only = inside.keys() - {path.name for path in folders} <= {"COLCON_IGNORE"}
    is_made = _has_marks(folder) or (bool(folders) and is_only and all(map(_has_marks, folders)))
    return is_made and not any(
        _is_source({*files}) and not _holds({*files}, _COPIES) for _, _, files in os.walk(folder)
    )


def _has_marks(folder: Path) -> bool:
    names = {path.name for path in folder.iterdir()}
    index = ("share/colcon-core", "share/ament_index")
    is_installed = "share" in names and any((folder / name).exists() for name in index)
    is_metadata = "PKG-INFO" in names and not _is_source(names)
    return is_installed or is_metadata or is_of_a_build(names)


def is_of_a_build(names: set[str]) -> bool:
    """Return whether only a build leaves files of these names in a folder."""
    return _holds(names, _MARKS)


def _holds(names: set[str], marks: Iterable[set[str]]) -> bool:
    return any(mark <= names for mark in marks)


def _is_source(names: set[str]) -> bool:
    """Return whether these are the names of a package's sources."""
    return "setup.py" in names or names >= {"package.xml", "CMakeLists.txt"}


def shown(text: str, longest: int = 200) -> str:
    """Return a text on one line, shortened, with all that a terminal would act upon escaped."""
    text = text if len(text) <= longest else f"{text[: longest - 1]}…"
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def _is_unicode(name: str) -> bool:
    try:
        name.encode()
    except UnicodeEncodeError:
        return False
    return True
