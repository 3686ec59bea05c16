"""The members of a folder, a zip or a tar, one by one; sizes in an archive's headers are never trusted."""

from __future__ import annotations

import bz2
import contextlib
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
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from ros2lab.grading.receiving.clean_copy import (
    CHUNK,
    DEEPEST_FOLDER,
    HAND_IN,
    LONGEST_PATH,
    TOOLS_NAMES,
    BeyondLimitsError,
    CleanCopy,
    Member,
    Meter,
    SubmissionError,
    opened,
    shown,
)
from ros2lab.grading.receiving.notes import Kind

DEEPEST_ARCHIVE = 3  # archives inside one another
MANIFESTS = frozenset(("package.xml", "setup.py"))

_LONGEST_HEADER = 1 << 18  # bytes, of everything before a member of a tar
_LARGEST_DIRECTORY = 1 << 23  # bytes, of the list of members in a zip


def in_folder(folder: Path, note: Callable[[Kind, str], None]) -> Iterator[Member]:
    """Yield the members of a folder.

    Args:
        folder: the folder, which is only read.
        note: called with the reason why something was left out, and its path.
    """

    def note_error(error: OSError) -> None:
        note("unreadable", str(error.filename))

    # By descriptors, so that nobody can replace what was looked at by a link.
    for parent, folders, files, descriptor in os.fwalk(folder, onerror=note_error):
        above = Path(parent).relative_to(folder)
        for name in sorted([*folders, *files]):
            try:
                yield from _in_place(str(above / name), name, descriptor)
            except OSError:
                note("unreadable", str(above / name))
        is_too_deep = len(above.parts) >= DEEPEST_FOLDER  # what lies here was noted already
        folders[:] = [name for name in sorted(folders) if not is_too_deep and not TOOLS_NAMES.fullmatch(name)]


def _in_place(path: str, name: str, descriptor: int) -> Iterator[Member]:
    mode = os.stat(name, dir_fd=descriptor, follow_symlinks=False).st_mode
    if stat.S_ISLNK(mode):
        yield Member(path, "link", target=os.readlink(name, dir_fd=descriptor))
    elif stat.S_ISDIR(mode):
        yield Member(path, "folder")
    elif stat.S_ISREG(mode):
        with opened(name, descriptor) as data:
            yield Member(path, "file", data, is_executable=bool(mode & 0o111))
    else:
        yield Member(path, "other")


def unpack(path: Path, copy: CleanCopy, below: tuple[str, ...] = ()) -> None:
    """Unpack an archive into a folder of the copy; SubmissionError if it is none, or broken."""
    try:
        copy.take(in_archive(path, copy.unpacked), below)
    except SubmissionError:
        raise
    except Exception as error:
        # Hostile bytes may make the readers raise anything; the only system error that they cause is EINVAL.
        if isinstance(error, OSError) and error.errno not in (None, errno.EINVAL):
            raise
        is_told = isinstance(error, (tarfile.ReadError, zipfile.BadZipFile)) and str(error)
        why = f" ({shown(str(error))})" if is_told else ""  # what else is raised says nothing of the archive
        raise SubmissionError(
            f"{shown(path.name)} is broken or incomplete{why}; pack it again, look whether it can be unpacked, and {HAND_IN}."
        ) from None


def unpack_inner(copy: CleanCopy) -> None:
    """Unpack the archives in the copy for as long as there is no package."""
    for _ in range(DEEPEST_ARCHIVE):
        archives = _inner_archives(copy.root)
        if not archives:
            return
        for archive in archives:
            target = _free_name(archive)
            below = target.relative_to(copy.root).parts
            try:
                unpack(archive, copy, below)
            except BeyondLimitsError:
                raise
            except SubmissionError as error:
                copy.note("not unpacked", str(error).rstrip("."))
                shutil.rmtree(target, ignore_errors=True)
            else:
                copy.note("unpacked", str(archive.relative_to(copy.root)))
            archive.unlink()
        copy.remove_built()
    for archive in _inner_archives(copy.root):
        inner = str(archive.relative_to(copy.root))
        copy.note("too deep", inner, DEEPEST_ARCHIVE)


_ARCHIVE = re.compile(
    r"(.+?)\.(zip|7z|rar|tgz|tbz2?|txz|tar(\.(gz|bz2|xz|lzma|zst))?)", re.IGNORECASE | re.DOTALL
)


def _inner_archives(root: Path) -> list[Path]:
    """Return the archives in the copy, or none if there is a package."""
    found = []
    for parent, _, files in os.walk(root):
        if MANIFESTS.intersection(files):
            return []
        found += [Path(parent, name) for name in files if _ARCHIVE.fullmatch(name)]
    return sorted(found)


def _free_name(archive: Path) -> Path:
    """Return an unused path beside an archive, named like it without its ending."""
    match = _ARCHIVE.fullmatch(archive.name)
    stem = (match[1] if match else "").strip(".") or "archive"
    names = itertools.chain([stem], (f"{stem}_{number}" for number in itertools.count(2)))
    return next(path for name in names if not os.path.lexists(path := archive.with_name(name)))


def in_archive(path: Path, meter: Meter) -> Iterator[Member]:
    """Yield the members of an archive, which is recognised by its first bytes and not by its name."""
    start = _start_of(path)
    unsupported = next((kind for magic, kind in _UNSUPPORTED.items() if start.startswith(magic)), None)
    open_tar = next((opener for magic, opener in _OPENERS.items() if start.startswith(magic)), None)
    if unsupported:
        raise SubmissionError(f"{shown(path.name)} is a {unsupported}, which is not unpacked; {HAND_IN}.")
    if start.startswith((b"PK\3\4", b"PK\5\6")):
        yield from _in_zip(path)
    elif open_tar or _is_tar(start):
        with (open_tar or _open)(path) as raw:
            yield from _in_tar(raw, meter)
    elif zipfile.is_zipfile(path):  # one that unpacks itself begins as a program
        yield from _in_zip(path)
    else:
        raise SubmissionError(
            f"{shown(path.name)} is a file, and neither a zip nor a tar archive; {HAND_IN}."
        )


def _start_of(path: Path) -> bytes:
    try:
        if not path.is_file():
            found = "is neither a folder nor a file" if path.exists() else "does not exist"
            raise SubmissionError(f"{shown(path.name)} {found}; {HAND_IN}.")
        with path.open("rb") as file:
            start = file.read(tarfile.BLOCKSIZE)
    except OSError as error:
        raise SubmissionError(
            f"{shown(path.name)} cannot be read ({error.strerror}); fix its permissions."
        ) from None
    if not start:
        raise SubmissionError(f"{shown(path.name)} is empty; {HAND_IN}.")
    return start


class _CarefulFile(io.FileIO):
    """A file for zipfile, which reads the list of all members in one go."""

    def read(self, size: int | None = -1) -> Any:
        most = _LARGEST_DIRECTORY + 1
        data = super().read(most if size is None or size < 0 else min(size, most))
        if data and len(data) == most:
            raise BeyondLimitsError(
                f"The list of what is in {shown(Path(str(self.name)).name)} is too long; "
                "hand in only what you have written."
            )
        return data


def _in_zip(path: Path) -> Iterator[Member]:
    with _CarefulFile(path) as file, zipfile.ZipFile(file) as archive:
        for info in archive.infolist():
            if info.flag_bits & 0x1:
                raise SubmissionError(
                    f"{shown(path.name)} is protected by a password; hand it in without one."
                )
            if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                # zipfile cannot limit how much other methods make of a few bytes.
                raise SubmissionError(
                    f"{shown(path.name)} is compressed in an unusual way (method {info.compress_type}); "
                    "pack it again with `zip` or as a .tar.gz."
                )
            yield from _in_zip_member(archive, info)


def _in_zip_member(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> Iterator[Member]:
    name, mode = _zip_name(info), info.external_attr >> 16 if info.create_system == _UNIX else 0
    if name.endswith("/"):
        yield Member(name, "folder")
    elif stat.S_IFMT(mode) not in (0, stat.S_IFREG, stat.S_IFLNK):
        yield Member(name, "other")
    else:
        with archive.open(info) as data:
            if stat.S_ISLNK(mode):
                yield Member(name, "link", target=os.fsdecode(data.read(LONGEST_PATH + 1)))
            else:
                yield Member(name, "file", data, is_executable=bool(mode & 0o111))  # type: ignore[arg-type]


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
        """Read a header, and raise if it is damaged; tarfile would take it for the end of the archive."""
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

    def __init__(self, raw: BinaryIO, meter: Meter) -> None:
        self._raw, self._meter, self._position = raw, meter, 0
        self.end: float = _LONGEST_HEADER

    def read(self, size: int) -> bytes:
        data = self._raw.read(size)
        self._position += len(data)
        self._meter.add(len(data))
        if self._position > self.end:
            raise tarfile.ReadError("a header is too long")
        return data


def _in_tar(raw: BinaryIO, meter: Meter) -> Iterator[Member]:
    stream: Any = _TarStream(raw, meter)
    with tarfile.open(fileobj=stream, mode="r|", tarinfo=_Header, encoding="utf-8") as archive:
        while (info := _next(archive)) is not None:
            stream.end = math.inf
            if info.isreg():
                data: Any = archive.extractfile(info)
                yield Member(info.name, "file", data, is_executable=bool(info.mode & 0o111))
            elif info.isdir():
                yield Member(info.name, "folder")
            elif info.issym():
                yield Member(info.name, "link", target=info.linkname)
            elif info.islnk():
                is_executable = bool(info.mode & 0o111)
                yield Member(info.name, "hard link", target=info.linkname, is_executable=is_executable)
            else:
                yield Member(info.name, "other")
            # tarfile holds everything before the next member in memory.
            stream.end = archive.offset + _LONGEST_HEADER
    stream.end = math.inf
    while stream.read(CHUNK):  # the check sum stands at the end
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
            f"{shown(path.name)} is compressed with zstd, which this Python cannot read (3.14 can); {HAND_IN}."
        ) from None


_OPENERS: Mapping[bytes, Callable[[Path], Any]] = {
    b"\x1f\x8b": gzip.open,
    b"BZh": bz2.open,
    b"\xfd7zXZ\0": lzma.open,
    b"\x5d\0\0": lzma.open,
    b"\x28\xb5\x2f\xfd": _open_zstd,
}
_UNSUPPORTED = {b"7z\xbc\xaf\x27\x1c": "7-Zip archive", b"Rar!\x1a\x07": "RAR archive"}
