"""What was handed in: a clean copy that is safe to read, and what was found in it.

Nothing of a submission is run or imported, and no number in an archive's headers is believed: bytes, files and
paths are counted while they are written. While files are written there are no links in the copy that could be
followed; links come last, and stay only if they lead to something inside.
"""

from __future__ import annotations

import ast
import bz2
import contextlib
import difflib
import errno
import gzip
import importlib
import io
import itertools
import lzma
import math
import os
import re
import shutil
import stat
import tarfile
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any, BinaryIO, Literal

from ros2lab.diagnose.node_source import NODE_CLASSES
from ros2lab.diagnose.package import SourcePackage
from ros2lab.diagnose.python_source import LARGEST_FILE as LARGEST_SOURCE
from ros2lab.diagnose.python_source import PythonSource, read_source, read_text
from ros2lab.diagnose.spelling import is_near_miss

# What a submission may hold. A file that is too large is left out; what is beyond the rest is not received.
MOST_BYTES = 500_000_000
MOST_MEMBERS = 30_000  # files, folders and links
MOST_LINKS = 1000
LARGEST_FILE = 50_000_000  # bytes
LONGEST_PATH = 1000  # bytes
DEEPEST_FOLDER = 40
DEEPEST_ARCHIVE = 3  # archives inside one another
# What is looked at in it; nobody writes more by hand.
MOST_PACKAGES = 50
MOST_SOURCE = 1_000_000  # bytes of Python

Form = Literal["workspace", "package", "files", "nothing"]

# As in hand_in, which needs ROS and 0.5 s to be imported.
_BUILT = ("build", "install", "log")
_NAME = "robot_controller"
_TOPICS = ("robot/status", "robot/command", "cmd_vel")


class SubmissionError(Exception):
    """What was handed in cannot be received; the text says what was found, and what to hand in."""


@dataclass(frozen=True)
class FoundPackage:
    """A package as it was handed in.

    Attributes:
        folder: where its package.xml or setup.py lies.
        name: by package.xml, else by setup.py; None if neither says it.
        build_type: what package.xml says; None if it says nothing or is not valid.
        error: a sentence that tells why package.xml cannot be used; None if it can.
    """

    folder: str
    name: str | None
    build_type: str | None
    error: str | None


@dataclass(frozen=True)
class Submission:
    """What was found. Every path is relative to the unpacked folder, which itself is `.`.

    Attributes:
        form: `workspace` (the package lies below a src), `package`, `files` (only Python files with nodes), or
            `nothing` that could be graded.
        workspace: the folder that has the src in which the assignment's package lies; None if there is none.
        packages: all packages, in the order of their folders.
        package: the one of them that is the assignment's.
        node_files: Python files outside any package that start or define a node.
        notes: sentences that tell what was left out, refused or unpacked.
    """

    form: Form
    workspace: str | None
    packages: tuple[FoundPackage, ...]
    package: FoundPackage | None
    node_files: tuple[str, ...]
    notes: tuple[str, ...]


def receive(path: Path, folder: Path) -> Submission:
    """Copy or unpack what was handed in, and look at it.

    Args:
        path: a folder, a zip or a tar; it is never changed.
        folder: an empty folder that is not inside `path`; nothing is written anywhere else. Permissions are
            reduced to 644, or 755 for folders and programs.

    Raises:
        SubmissionError: if nothing can be received: nothing is there, or it is no archive, encrypted, broken,
            empty or beyond the limits. What has been written by then stays in `folder`.
        ValueError: if `folder` is not empty or lies in `path`.
    """
    root, path = folder.resolve(strict=True), path.absolute()
    if any(root.iterdir()):
        raise ValueError(f"{folder} is not empty; give an empty folder.")
    if root.is_relative_to(os.path.realpath(path)):
        raise ValueError(f"{folder} lies in {path}, which is copied into it; give a folder outside.")
    copy = _Copy(root)
    if os.path.isdir(path):  # noqa: PTH112 -- False where pathlib raises
        copy.take(_in_folder(path, copy.note))
    else:
        _unpack(path, copy)
    copy.remove_built()
    _unpack_inner(copy)
    links = copy.make_links()
    files = sorted(
        PurePosixPath(parent, name).relative_to(root.as_posix())
        for parent, _, names in os.walk(root)
        for name in names
    )
    if not files:
        found = f"holds nothing to grade ({copy.notes[0].rstrip('.')})" if copy.notes else "is empty"
        raise SubmissionError(f"{_shown(path.name)} {found}; {_HAND_IN}.")
    return _look(root, files, links, copy)


# --- unpacking --------------------------------------------------------------------------------------------

_HAND_IN = "hand in the workspace as a folder, a .zip or a .tar.gz"
_CHUNK = 1 << 16  # bytes
_MOST_LINKS_IN_A_ROW = 20  # Linux follows 40
_LONGEST_HEADER = 1 << 18  # bytes, of all that stands before a member of a tar
_LARGEST_DIRECTORY = 1 << 23  # bytes, of the list of members in a zip

_OUTSIDE = "Refused, because it leads out of the submission"
_NO_TARGET = "Left out, because it links to nothing that was handed in"
_NO_FILE = "Refused, because it is neither a file nor a folder nor a link"
_BY_TOOL = "Left out, because a tool made it"
_PATH_TOO_LONG = "Left out, because its path is too long or too deep"
_NAME_TAKEN = "Left out, because something else has the same name"
_UNREADABLE = "Left out, because it cannot be read"
_NOT_UNICODE = "Kept, though its name is not valid Unicode"
_INNER = "Unpacked, because there was no package outside it"

_TOOLS_NAMES = re.compile(
    r"\.git|\.hg|\.svn|\.venv|venv|node_modules|\.tox|\.(mypy|pytest|ruff)_cache|\.ipynb_checkpoints"
    r"|__pycache__|.*\.py[co]|.*\.egg-info|\.idea|\.vscode|__MACOSX|\._.*|\.DS_Store|Thumbs\.db|desktop\.ini",
    re.DOTALL,
)
# What colcon leaves in build, install and log.
_COLCONS = {"COLCON_IGNORE", "setup.bash", "local_setup.bash", ".colcon_install_layout", ".built_by"}


class _BeyondLimitsError(SubmissionError):
    pass


class _Meter:
    """Counts bytes as far as there may be."""

    def __init__(self) -> None:
        self._bytes = 0

    def add(self, count: int) -> None:
        self._bytes += count
        if self._bytes > MOST_BYTES:
            raise _BeyondLimitsError(
                f"The submission holds more than {MOST_BYTES / 1e6:g} MB; hand in only what you have written."
            )


@dataclass(frozen=True)
class _Member:
    """One thing that was handed in: `data` of a file, `target` of a link."""

    name: str
    kind: Literal["file", "folder", "link", "hard link", "other"]
    data: BinaryIO | None = None
    target: str = ""
    is_executable: bool = False


class _Copy:
    """The clean copy while it is written."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.unpacked = _Meter()  # what comes out of compressed tars, kept or not
        self._written = _Meter()
        self._members = 0
        self._links: dict[Path, str] = {}
        self._noted: dict[str, dict[str, None]] = {}

    def note(self, reason: str, name: str) -> None:
        """Note what was done with a member and why."""
        self._noted.setdefault(reason, {})[_shown(name)] = None

    @property
    def notes(self) -> tuple[str, ...]:
        """A sentence for each reason."""
        return tuple(f"{reason}: {_listed([*names])}." for reason, names in self._noted.items())

    def take(self, members: Iterable[_Member], below: tuple[str, ...] = ()) -> None:
        """Write the members below a folder of the copy; of two with the same name the later one stays."""
        for member in members:
            self._count()
            own = tuple(part for part in member.name.split("/") if part not in ("", "."))
            by_tool = next((n for n, part in enumerate(own, 1) if _TOOLS_NAMES.fullmatch(part)), None)
            if by_tool is not None:
                self.note(_BY_TOOL, "/".join((*below, *own[:by_tool])))
            elif reason := _path_fault(member.name, (*below, *own)):
                self.note(reason, member.name)
            elif own:
                self._take(member, self.root.joinpath(*below, *own), below)

    def _take(self, member: _Member, path: Path, below: tuple[str, ...]) -> None:
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

    def _copy_inside(self, member: _Member, path: Path, below: tuple[str, ...]) -> None:
        if reason := _path_fault(member.target, (*below, *member.target.split("/"))):
            self.note(reason, f"{member.name} -> {member.target}")
            return
        source = self.root.joinpath(*below, member.target)
        if not source.is_file():
            self.note(_NO_TARGET, f"{member.name} -> {member.target}")
            return
        with source.open("rb") as data:
            self._write(member, path, data)

    def _write(self, member: _Member, path: Path, data: BinaryIO) -> None:
        if path.is_dir():
            self.note(_NAME_TAKEN, member.name)
            return
        path.unlink(missing_ok=True)
        size = 0
        with path.open("xb") as file:
            while size <= LARGEST_FILE and (chunk := data.read(_CHUNK)):
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
            raise _BeyondLimitsError(
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
                    self.note(_BY_TOOL, str(path.relative_to(self.root)))

    def make_links(self) -> dict[Path, Path]:
        """Make the links that lead to something in the copy without leaving it on their way.

        Returns:
            Where each link leads.
        """
        links = {path: target for path, target in self._links.items() if path.parent.is_dir()}
        for path in [path for path in links if path.exists()]:
            self._note_link(_NAME_TAKEN, path, links.pop(path))
        if len(links) > MOST_LINKS:
            raise _BeyondLimitsError(f"The submission holds more than {MOST_LINKS} links; {_HAND_IN}.")
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
    """Tell whether colcon or setup.py has made a folder of this name."""
    inside = {path.name for path in folder.iterdir()}
    if "package.xml" in inside:
        return False
    is_by_setup = folder.name == "build" and "setup.py" in beside
    return is_by_setup or bool(inside & _COLCONS or beside & {"src", *_BUILT} - {folder.name})


def _in_folder(folder: Path, note: Callable[[str, str], None]) -> Iterator[_Member]:
    def note_error(error: OSError) -> None:
        note(_UNREADABLE, str(error.filename))

    # By descriptors, so that nobody can put a link in the place of what was looked at.
    for parent, folders, files, descriptor in os.fwalk(folder, onerror=note_error):
        above = Path(parent).relative_to(folder)
        for name in sorted([*folders, *files]):
            try:
                yield from _in_place(str(above / name), name, descriptor)
            except OSError:
                note(_UNREADABLE, str(above / name))
        is_too_deep = len(above.parts) >= DEEPEST_FOLDER  # what lies here was noted already
        folders[:] = [
            name for name in sorted(folders) if not is_too_deep and not _TOOLS_NAMES.fullmatch(name)
        ]


def _in_place(shown: str, name: str, descriptor: int) -> Iterator[_Member]:
    mode = os.stat(name, dir_fd=descriptor, follow_symlinks=False).st_mode
    if stat.S_ISLNK(mode):
        yield _Member(shown, "link", target=os.readlink(name, dir_fd=descriptor))
    elif stat.S_ISDIR(mode):
        yield _Member(shown, "folder")
    elif stat.S_ISREG(mode):
        flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK
        with os.fdopen(os.open(name, flags, dir_fd=descriptor), "rb") as data:
            yield _Member(shown, "file", data, is_executable=bool(mode & 0o111))
    else:
        yield _Member(shown, "other")


def _unpack(path: Path, copy: _Copy, below: tuple[str, ...] = ()) -> None:
    try:
        copy.take(_in_archive(path, copy.unpacked), below)
    except SubmissionError:
        raise
    except Exception as error:
        # Hostile bytes make the readers raise anything; what the system says of them is at most EINVAL.
        if isinstance(error, OSError) and error.errno not in (None, errno.EINVAL):
            raise
        raise SubmissionError(
            f"{_shown(path.name)} is broken or incomplete ({_shown(str(error) or type(error).__name__)}); "
            f"pack it again, look whether it can be unpacked, and {_HAND_IN}."
        ) from None


def _unpack_inner(copy: _Copy) -> None:
    """Unpack the archives in the copy for as long as there is no package."""
    for _ in range(DEEPEST_ARCHIVE):
        archives = _inner_archives(copy.root)
        if not archives:
            return
        for archive in archives:
            target = _free_name(archive)
            below = target.relative_to(copy.root).parts
            try:
                _unpack(archive, copy, below)
            except _BeyondLimitsError:
                raise
            except SubmissionError as error:
                copy.note("Not unpacked", str(error).rstrip("."))
                shutil.rmtree(target, ignore_errors=True)
            else:
                copy.note(_INNER, str(archive.relative_to(copy.root)))
            archive.unlink()
        copy.remove_built()
    for archive in _inner_archives(copy.root):
        shown = str(archive.relative_to(copy.root))
        copy.note(f"Not unpacked, because it lies in more than {DEEPEST_ARCHIVE} archives", shown)


_ARCHIVE = re.compile(
    r"(.+?)\.(zip|7z|rar|tgz|tbz2?|txz|tar(\.(gz|bz2|xz|lzma|zst))?)", re.IGNORECASE | re.DOTALL
)


def _inner_archives(root: Path) -> list[Path]:
    """Return the archives in the copy, or none if there is a package."""
    found = []
    for parent, _, files in os.walk(root):
        if _MANIFESTS.intersection(files):
            return []
        found += [Path(parent, name) for name in files if _ARCHIVE.fullmatch(name)]
    return sorted(found)


def _free_name(archive: Path) -> Path:
    """Return a path beside an archive that is like its name and not in use."""
    match = _ARCHIVE.fullmatch(archive.name)
    stem = (match[1] if match else "").strip(".") or "archive"
    names = itertools.chain([stem], (f"{stem}_{number}" for number in itertools.count(2)))
    return next(path for name in names if not os.path.lexists(path := archive.with_name(name)))


def _in_archive(path: Path, meter: _Meter) -> Iterator[_Member]:
    """Yield the members of an archive, which is recognised by how it begins and not by its name."""
    start = _start_of(path)
    unsupported = next((kind for magic, kind in _UNSUPPORTED.items() if start.startswith(magic)), None)
    open_tar = next((opener for magic, opener in _OPENERS.items() if start.startswith(magic)), None)
    if unsupported:
        raise SubmissionError(f"{_shown(path.name)} is a {unsupported}, which is not unpacked; {_HAND_IN}.")
    if start.startswith((b"PK\3\4", b"PK\5\6")):
        yield from _in_zip(path)
    elif open_tar or _is_tar(start):
        with (open_tar or _open)(path) as raw:
            yield from _in_tar(raw, meter)
    elif zipfile.is_zipfile(path):  # one that unpacks itself begins as a program
        yield from _in_zip(path)
    else:
        raise SubmissionError(
            f"{_shown(path.name)} is a file, and neither a zip nor a tar archive; {_HAND_IN}."
        )


def _start_of(path: Path) -> bytes:
    try:
        if not path.is_file():
            found = "is neither a folder nor a file" if path.exists() else "does not exist"
            raise SubmissionError(f"{_shown(path.name)} {found}; {_HAND_IN}.")
        with path.open("rb") as file:
            start = file.read(tarfile.BLOCKSIZE)
    except OSError as error:
        raise SubmissionError(
            f"{_shown(path.name)} cannot be read ({error.strerror}); mend its permissions."
        ) from None
    if not start:
        raise SubmissionError(f"{_shown(path.name)} is empty; {_HAND_IN}.")
    return start


class _CarefulFile(io.FileIO):
    """A file for zipfile, which reads the list of all members in one go."""

    def read(self, size: int | None = -1) -> Any:
        most = _LARGEST_DIRECTORY + 1
        data = super().read(most if size is None or size < 0 else min(size, most))
        if data and len(data) == most:
            raise _BeyondLimitsError(
                f"The list of what is in {_shown(Path(str(self.name)).name)} is too long; "
                "hand in only what you have written."
            )
        return data


def _in_zip(path: Path) -> Iterator[_Member]:
    with _CarefulFile(path) as file, zipfile.ZipFile(file) as archive:
        for info in archive.infolist():
            if info.flag_bits & 0x1:
                raise SubmissionError(
                    f"{_shown(path.name)} is protected by a password; hand it in without one."
                )
            if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                # zipfile cannot bound what other methods make of a few bytes.
                raise SubmissionError(
                    f"{_shown(path.name)} is compressed in an unusual way (method {info.compress_type}); "
                    "pack it again with `zip` or as a .tar.gz."
                )
            yield from _in_zip_member(archive, info)


def _in_zip_member(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> Iterator[_Member]:
    name, mode = _zip_name(info), info.external_attr >> 16 if info.create_system == _UNIX else 0
    if name.endswith("/"):
        yield _Member(name, "folder")
    elif stat.S_IFMT(mode) not in (0, stat.S_IFREG, stat.S_IFLNK):
        yield _Member(name, "other")
    else:
        with archive.open(info) as data:
            if stat.S_ISLNK(mode):
                yield _Member(name, "link", target=os.fsdecode(data.read(LONGEST_PATH + 1)))
            else:
                yield _Member(name, "file", data, is_executable=bool(mode & 0o111))  # type: ignore[arg-type]


_UNIX = 3  # the system that made a member of a zip
_UTF_8 = 0x800  # the flag of a name in UTF-8


def _zip_name(info: zipfile.ZipInfo) -> str:
    name = info.filename
    if not info.flag_bits & _UTF_8:
        # Where the flag is missing the bytes are mostly UTF-8 all the same (macOS), or else cp437.
        with contextlib.suppress(UnicodeError):
            name = name.encode("cp437").decode("utf-8")
    return name if info.create_system == _UNIX else name.replace("\\", "/")


class _Header(tarfile.TarInfo):
    @classmethod
    def frombuf(cls, buf: bytes | bytearray, encoding: str, errors: str) -> _Header:
        """Read a header; tarfile takes one that is damaged for the end of the archive."""
        try:
            return super().frombuf(buf, encoding, errors)
        except tarfile.HeaderError as error:
            if not buf.strip(b"\0"):
                raise
            raise tarfile.ReadError(f"not a tar archive, or damaged: {error}") from None


def _is_tar(start: bytes) -> bool:
    try:
        _Header.frombuf(start, "utf-8", "surrogateescape")
    except tarfile.TarError:
        # An empty tar is nothing but zeros.
        return len(start) == tarfile.BLOCKSIZE and not start.strip(b"\0")
    return True


class _TarStream:
    """What a tar holds, decompressed, counted, and read no further than `end`."""

    def __init__(self, raw: BinaryIO, meter: _Meter) -> None:
        self._raw, self._meter, self._position = raw, meter, 0
        self.end: float = _LONGEST_HEADER

    def read(self, size: int) -> bytes:
        data = self._raw.read(size)
        self._position += len(data)
        self._meter.add(len(data))
        if self._position > self.end:
            raise tarfile.ReadError("a header is too long")
        return data


def _in_tar(raw: BinaryIO, meter: _Meter) -> Iterator[_Member]:
    stream: Any = _TarStream(raw, meter)
    with tarfile.open(fileobj=stream, mode="r|", tarinfo=_Header, encoding="utf-8") as archive:
        while (info := _next(archive)) is not None:
            stream.end = math.inf
            if info.isreg():
                data: Any = archive.extractfile(info)
                yield _Member(info.name, "file", data, is_executable=bool(info.mode & 0o111))
            elif info.isdir():
                yield _Member(info.name, "folder")
            elif info.issym():
                yield _Member(info.name, "link", target=info.linkname)
            elif info.islnk():
                is_executable = bool(info.mode & 0o111)
                yield _Member(info.name, "hard link", target=info.linkname, is_executable=is_executable)
            else:
                yield _Member(info.name, "other")
            # tarfile holds all that comes before the next member in memory.
            stream.end = archive.offset + _LONGEST_HEADER
    stream.end = math.inf
    while stream.read(_CHUNK):  # the check sum stands at the end
        pass


def _next(archive: tarfile.TarFile) -> tarfile.TarInfo | None:
    try:
        return archive.next()
    except tarfile.StreamError:
        if archive.offset:
            raise
        return None  # an empty tar, of which Python 3.10 cannot be asked twice


def _open(path: Path) -> BinaryIO:
    return path.open("rb")


def _open_zstd(path: Path) -> Any:
    try:
        return importlib.import_module("compression.zstd").open(path, "rb")
    except ImportError:
        raise SubmissionError(
            f"{_shown(path.name)} is compressed with zstd, which this Python cannot read (3.14 can); {_HAND_IN}."
        ) from None


_OPENERS: Mapping[bytes, Callable[[Path], Any]] = {
    b"\x1f\x8b": gzip.open,
    b"BZh": bz2.open,
    b"\xfd7zXZ\0": lzma.open,
    b"\x5d\0\0": lzma.open,
    b"\x28\xb5\x2f\xfd": _open_zstd,
}
_UNSUPPORTED = {b"7z\xbc\xaf\x27\x1c": "7-Zip archive", b"Rar!\x1a\x07": "RAR archive"}


# --- looking ----------------------------------------------------------------------------------------------

_MANIFESTS = frozenset(("package.xml", "setup.py"))
IGNORED = frozenset(("COLCON_IGNORE", "AMENT_IGNORE"))
_STARTS = NODE_CLASSES | {"rclpy.init", "rclpy.create_node"}
_LONGEST_TOPIC = 100  # characters


def _look(root: Path, files: Sequence[PurePosixPath], links: Mapping[Path, Path], copy: _Copy) -> Submission:
    folders = _package_folders(files, copy)
    packages = {folder: _package(root, folder) for folder in folders}
    sources: dict[PurePosixPath | None, list[PythonSource]] = {}
    for source in _sources(root, files, copy):
        owner = _owner(PurePosixPath(source.shown), folders)
        sources.setdefault(owner, []).append(source)
    workspaces = {folder: _workspace(root, folder, links) for folder in folders}
    chosen = _assignment(packages, sources, workspaces, copy)
    node_files = tuple(source.shown for source in sources.get(None, []) if _starts_node(source))
    workspace = workspaces[chosen] if chosen else None
    form: Form = "workspace" if workspace else "package" if chosen else "files" if node_files else "nothing"
    package = packages[chosen] if chosen else None
    return Submission(form, workspace, tuple(packages.values()), package, node_files, copy.notes)


def _package_folders(files: Iterable[PurePosixPath], copy: _Copy) -> list[PurePosixPath]:
    """Return the folders with a package.xml, or with a setup.py outside of any such folder."""
    files = [*files]
    ignored = {file.parent for file in files if file.name in IGNORED}
    for folder in sorted(ignored):
        copy.note("colcon does not look into this folder, because a COLCON_IGNORE lies in it", str(folder))
    seen = [file for file in files if not ignored.intersection(file.parents)]
    if not any(file.name in _MANIFESTS for file in seen):
        seen = files  # what colcon does not see is better than nothing
    manifests = {file.parent for file in seen if file.name == "package.xml"}
    scripts = {file.parent for file in seen if file.name == "setup.py"}
    found = manifests | {folder for folder in scripts if not manifests.intersection(folder.parents)}
    for folder in sorted(found):
        if found.intersection(folder.parents):
            copy.note("colcon does not see this package, because it lies in another one", str(folder))
    highest = sorted(found, key=lambda folder: (len(folder.parts), folder))
    for folder in highest[MOST_PACKAGES:]:
        copy.note(f"Not looked at, because there are more than {MOST_PACKAGES} packages", str(folder))
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
        # A few of them make gigabytes when they are parsed.
        return "package.xml is not valid: it defines entities, which no package.xml needs."
    if source.manifest is None:
        return f"package.xml is not valid: {_shown(source.manifest_fault or '', 300).rstrip('.')}."
    return None


def _sources(root: Path, files: Iterable[PurePosixPath], copy: _Copy) -> Iterator[PythonSource]:
    """Yield the Python files that have to do with ROS or the assignment, those that lie highest first."""
    words = re.compile("rclpy|" + "|".join(topic.rpartition("/")[2] for topic in _TOPICS))
    budget = MOST_SOURCE
    scripts = [file for file in files if file.suffix == ".py" and file.name != "setup.py"]
    for file in sorted(scripts, key=lambda file: (len(file.parts), file)):
        source = read_source(root / file, file.stem, str(file))
        if words.search(source.text):
            budget -= len(source.text)
            if budget < 0:
                copy.note(
                    f"Not looked at, because there is more than {MOST_SOURCE} bytes of Python", str(file)
                )
            else:
                yield source
        elif (root / file).stat().st_size > LARGEST_SOURCE:
            copy.note(f"Not looked at, because it is larger than {LARGEST_SOURCE} bytes", str(file))


def _owner(file: PurePosixPath, folders: Iterable[PurePosixPath]) -> PurePosixPath | None:
    """Return the package in which a file lies."""
    inside = [folder for folder in folders if folder in file.parents]
    return max(inside, key=lambda folder: len(folder.parts), default=None)


def _workspace(root: Path, folder: PurePosixPath, links: Mapping[Path, Path]) -> str | None:
    """Return the folder whose src holds a package, directly, somewhere below, or by a link."""
    there = root / folder
    by_link = [
        (link / there.relative_to(end)).relative_to(root)
        for link, end in links.items()
        if there.is_relative_to(end)
    ]
    for path in [folder, *map(PurePosixPath, sorted(by_link))]:
        sources = [one for one in (path, *path.parents) if one.name == "src"]
        if sources:
            return str(sources[0].parent)
    return None


def _assignment(
    packages: Mapping[PurePosixPath, FoundPackage],
    sources: Mapping[PurePosixPath | None, Sequence[PythonSource]],
    workspaces: Mapping[PurePosixPath, str | None],
    copy: _Copy,
) -> PurePosixPath | None:
    """Return the folder of the package that looks most like the assignment's.

    Of equals the one in a workspace is taken, then the one that lies higher, and that is noted.
    """
    likeness = {
        folder: _likeness(package.name or folder.name, sources.get(folder, []))
        for folder, package in packages.items()
    }
    best = max(likeness.values(), default=0.0)
    equal = [folder for folder, value in likeness.items() if value == best]
    equal.sort(key=lambda folder: (workspaces[folder] is None, len(folder.parts), folder))
    for other in equal[1:]:
        copy.note(f"Not graded, because it looks like the package in {_shown(str(equal[0]))}", str(other))
    return equal[0] if equal else None


def _likeness(name: str, sources: Iterable[PythonSource]) -> float:
    """Return how much a package looks like the assignment's: by topics, rclpy and its name.

    A topic counts 2, or 1 if it is misspelt; rclpy counts 2, and the name as much as 3.
    """
    words, imports_rclpy = set(), False
    for source in sources:
        imports_rclpy |= any(one.target.partition(".")[0] == "rclpy" for one in source.imports)
        strings = (node.value for node in source.nodes if isinstance(node, ast.Constant))
        words |= {text.strip("/") for text in strings if isinstance(text, str) and len(text) < _LONGEST_TOPIC}
    topics = 0
    for topic in _TOPICS:
        if any(f"/{word}".endswith(f"/{topic}") for word in words):
            topics += 2
        elif any(is_near_miss(word, topic) for word in words):
            topics += 1
    alike = difflib.SequenceMatcher(None, name[:_LONGEST_TOPIC].lower(), _NAME).ratio()
    return topics + 2 * imports_rclpy + 3 * alike


def _starts_node(source: PythonSource) -> bool:
    """Tell whether a file defines a node or starts ROS; one that Python cannot read only has to import rclpy."""
    targets = {one.target for one in source.imports}
    if source.fault:
        return re.search(r"^\s*(import|from)\s+rclpy\b", source.text, re.MULTILINE) is not None
    used = [base for node in source.nodes if isinstance(node, ast.ClassDef) for base in node.bases]
    used += [node.func for node in source.nodes if isinstance(node, ast.Call)]
    return not targets.isdisjoint(("rclpy.*", "rclpy.node.*")) or any(
        source.resolve(one) in _STARTS for one in used
    )


# --- words ------------------------------------------------------------------------------------------------


def _listed(names: Sequence[str]) -> str:
    more = len(names) - 5
    return ", ".join(names[:5]) + (f" and {more} more" if more > 0 else "")


def _shown(text: str, longest: int = 200) -> str:
    """Return a text on one line, shortened, without anything that a terminal would take for a command."""
    text = text if len(text) <= longest else f"{text[: longest - 1]}…"
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def _is_unicode(name: str) -> bool:
    try:
        name.encode()
    except UnicodeEncodeError:
        return False
    return True
