"""The clean copy of what was handed in, while it is written.

Bytes, files and paths are counted while they are written. Until then there are no links in the copy that could be
followed; links come last, and stay only if they lead to something inside.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Literal

# What a submission may hold. A file that is too large is left out; what is beyond the rest is not received.
MOST_BYTES = 500_000_000
MOST_MEMBERS = 30_000  # files, folders and links
MOST_LINKS = 1000
LARGEST_FILE = 50_000_000  # bytes
LONGEST_PATH = 1000  # bytes
DEEPEST_FOLDER = 40

HAND_IN = "hand in the workspace as a folder, a .zip or a .tar.gz"
CHUNK = 1 << 16  # bytes
_MOST_LINKS_IN_A_ROW = 20  # Linux follows 40

_OUTSIDE = "Refused, because it leads out of the submission"
_NO_TARGET = "Left out, because it links to nothing that was handed in"
_NO_FILE = "Refused, because it is neither a file nor a folder nor a link"
_BY_TOOL = "Left out, because a tool made it"
_BY_BUILD = "Left out, because a build made it"
_PATH_TOO_LONG = "Left out, because its path is too long or too deep"
_NAME_TAKEN = "Left out, because something else has the same name"
_NOT_UNICODE = "Kept, though its name is not valid Unicode"

# As in hand_in, which needs ROS and 0.5 s to be imported.
_BUILT = ("build", "install", "log")
TOOLS_NAMES = re.compile(
    r"\.git|\.hg|\.svn|\.venv|venv|node_modules|\.tox|\.(mypy|pytest|ruff)_cache|\.ipynb_checkpoints"
    r"|__pycache__|.*\.py[co]|.*\.egg-info|\.idea|\.vscode|__MACOSX|\._.*|\.DS_Store|Thumbs\.db|desktop\.ini",
    re.DOTALL,
)
# What colcon leaves in build, install and log.
_COLCONS = {"COLCON_IGNORE", "setup.bash", "local_setup.bash", ".colcon_install_layout", ".built_by"}


class SubmissionError(Exception):
    """What was handed in cannot be received; the text says what was found, and what to hand in."""


class BeyondLimitsError(SubmissionError):
    """It holds more than a submission may."""


class Meter:
    """Counts bytes as far as there may be."""

    def __init__(self) -> None:
        self._bytes = 0

    def add(self, count: int) -> None:
        """Count so many bytes more; BeyondLimitsError if that is too much."""
        self._bytes += count
        if self._bytes > MOST_BYTES:
            raise BeyondLimitsError(
                f"The submission holds more than {MOST_BYTES / 1e6:g} MB; hand in only what you have written."
            )


@dataclass(frozen=True)
class Member:
    """One thing that was handed in: `data` of a file, `target` of a link."""

    name: str
    kind: Literal["file", "folder", "link", "hard link", "other"]
    data: BinaryIO | None = None
    target: str = ""
    is_executable: bool = False


class CleanCopy:
    """The clean copy while it is written."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.unpacked = Meter()  # what comes out of compressed tars, kept or not
        self._written = Meter()
        self._members = 0
        self._links: dict[Path, str] = {}
        self._noted: dict[str, dict[str, None]] = {}

    def note(self, reason: str, name: str) -> None:
        """Note what was done with a member and why."""
        self._noted.setdefault(reason, {})[shown(name)] = None

    @property
    def notes(self) -> tuple[str, ...]:
        """A sentence for each reason."""
        return tuple(f"{reason}: {_listed([*names])}." for reason, names in self._noted.items())

    def take(self, members: Iterable[Member], below: tuple[str, ...] = ()) -> None:
        """Write the members below a folder of the copy; of two with the same name the later one stays."""
        for member in members:
            self._count()
            own = tuple(part for part in member.name.split("/") if part not in ("", "."))
            by_tool = next((n for n, part in enumerate(own, 1) if TOOLS_NAMES.fullmatch(part)), None)
            if by_tool is not None:
                self.note(_BY_TOOL, "/".join((*below, *own[:by_tool])))
            elif reason := _path_fault(member.name, (*below, *own)):
                self.note(reason, member.name)
            elif own:
                self._take(member, self.root.joinpath(*below, *own), below)

    def _take(self, member: Member, path: Path, below: tuple[str, ...]) -> None:
        if member.kind == "other":
            self.note(_NO_FILE, member.name)
            return
        if not self._make_folder(path if member.kind == "folder" else path.parent):
            self.note(_NAME_TAKEN, member.name)
            return
        if not _is_unicode(member.name):
            self.note(_NOT_UNICODE, member.name)
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
            self.note(_NO_TARGET, f"{member.name} -> {member.target}")
            return
        with source.open("rb") as data:
            self._write(member, path, data)

    def _write(self, member: Member, path: Path, data: BinaryIO) -> None:
        if path.is_dir():
            self.note(_NAME_TAKEN, member.name)
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
            self.note(f"Left out, because it is larger than {LARGEST_FILE / 1e6:g} MB", member.name)

    def _make_folder(self, path: Path) -> bool:
        """Make a folder and those above it; False if a file is in the way."""
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
        """Remove what colcon has made, and virtual environments."""
        for parent, folders, files in os.walk(self.root):
            beside = {*folders, *files}
            for name in sorted(folders):
                path = Path(parent, name)
                is_built = name in _BUILT and _is_built(path, beside)
                if is_built or (path / "pyvenv.cfg").exists():
                    shutil.rmtree(path)
                    folders.remove(name)
                    self.note(_BY_BUILD if is_built else _BY_TOOL, str(path.relative_to(self.root)))

    def make_links(self) -> dict[Path, Path]:
        """Make the links that lead to something in the copy without leaving it on their way.

        Returns:
            Where each link leads.
        """
        links = {path: target for path, target in self._links.items() if path.parent.is_dir()}
        for path in [path for path in links if path.exists()]:
            self._note_link(_NAME_TAKEN, path, links.pop(path))
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

    def _note_link(self, reason: str, path: Path, target: str) -> None:
        self.note(reason, f"{path.relative_to(self.root)} -> {target}")


def _ends(root: Path, links: Mapping[Path, str]) -> dict[Path, Path | str]:
    """Tell where links would lead if they were made: a path in the root, or the reason why one cannot stay."""
    ends: dict[Path, Path | str] = {}

    def follow(link: Path, depth: int) -> Path | str:
        target = links[link]
        if link in ends:
            pass
        elif target.startswith("/"):
            ends[link] = _OUTSIDE
        elif not target or "\0" in target or depth > _MOST_LINKS_IN_A_ROW or _is_too_long(target.split("/")):
            ends[link] = _NO_TARGET
        else:
            ends[link] = walk(link.parent, target.split("/"), depth)
        return ends[link]

    def walk(here: Path, parts: Sequence[str], depth: int) -> Path | str:
        for part in parts:
            if not here.is_dir():
                return _NO_TARGET
            if part == "..":
                if here == root:
                    return _OUTSIDE
                here = here.parent
            elif part not in ("", "."):
                here /= part
                end = follow(here, depth + 1) if here in links else here
                if isinstance(end, str):
                    return end
                here = end
        return here if here.exists() else _NO_TARGET

    for link in links:
        follow(link, 0)
    return ends


def _path_fault(name: str, parts: tuple[str, ...]) -> str | None:
    """Return why nothing can be written under this name; `parts` are all folders on the way."""
    if name.startswith("/") or ".." in name.split("/") or "\0" in name:
        return _OUTSIDE
    return _PATH_TOO_LONG if _is_too_long(parts) else None


def _is_too_long(parts: Sequence[str]) -> bool:
    lengths = [len(os.fsencode(part)) for part in parts]
    return len(parts) > DEEPEST_FOLDER or sum(lengths) > LONGEST_PATH or max(lengths, default=0) > 255


def _is_built(folder: Path, beside: set[str]) -> bool:
    """Return whether colcon or setup.py has made a folder of this name."""
    inside = {path.name for path in folder.iterdir()}
    if "package.xml" in inside:
        return False
    is_by_setup = folder.name == "build" and "setup.py" in beside
    return is_by_setup or bool(inside & _COLCONS or beside & {"src", *_BUILT} - {folder.name})


def _listed(names: Sequence[str]) -> str:
    more = len(names) - 5
    return ", ".join(names[:5]) + (f" and {more} more" if more > 0 else "")


def shown(text: str, longest: int = 200) -> str:
    """Return a text on one line, shortened, without anything that a terminal would take for a command."""
    text = text if len(text) <= longest else f"{text[: longest - 1]}…"
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def _is_unicode(name: str) -> bool:
    try:
        name.encode()
    except UnicodeEncodeError:
        return False
    return True
