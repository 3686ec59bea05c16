"""Archives and folders with members that no one writes by hand: they lead out, are huge, or are no files at all."""

from __future__ import annotations

import io
import os
import struct
import tarfile
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path

from corpus.case import Case, Make
from corpus.hostile.making import packed
from corpus.package import MODEL, README, STATUS, XML, YAML, M, P
from corpus.tree import (
    Change,
    Content,
    Link,
    as_folder,
    as_tar,
    as_zip,
    edit,
    filled,
    made,
    put,
    write,
    zip_bytes,
)

_OUT = "../../../../../../../../../../tmp/@TOKEN@"


def _zip_with(*members: tuple[str, str]) -> Make:
    """Hand in a zip with the model and members whose names may be anything."""

    def make(folder: Path, values: Mapping[str, str]) -> Path:
        files: dict[str, Content] = {**MODEL, **{str(filled(name, values)): text for name, text in members}}
        return as_zip(files)(folder, values)

    return make


def _member(
    name: str, kind: bytes = tarfile.REGTYPE, target: str = "", data: bytes = b""
) -> tuple[tarfile.TarInfo, bytes]:
    info = tarfile.TarInfo(name)
    info.type, info.linkname = kind, target
    if kind in (tarfile.CHRTYPE, tarfile.BLKTYPE):
        info.devmajor, info.devminor = 1, 8  # /dev/random
    return info, data


def _tar(name: str, about: str, *members: tuple[tarfile.TarInfo, bytes]) -> Case:
    return packed(f"tar_{name}", about, as_tar(MODEL, *members))


def _file(name: str, data: Callable[[], bytes]) -> Make:
    def make(folder: Path, values: Mapping[str, str]) -> Path:
        (folder / name).write_bytes(data())
        return folder / name

    return make


def _encrypted() -> bytes:
    """Return a zip whose members say that they are encrypted."""
    data = bytearray(zip_bytes({"work/notes.txt": "secret\n"}, {}))
    for signature, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        place = data.index(signature) + offset
        flags = struct.unpack_from("<H", data, place)[0]
        struct.pack_into("<H", data, place, flags | 1)
    return bytes(data)


def _zip_bomb() -> bytes:
    """Return a zip of 520 MB of zeros: a little more than is received."""
    buffer, zeros = io.BytesIO(), bytes(10_000_000)
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for number in range(52):
            archive.writestr(f"work/{number}.bin", zeros)
    return buffer.getvalue()


def _many_members() -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for number in range(30_100):
            archive.writestr(f"{number}", b"")
    return buffer.getvalue()


def _liar() -> bytes:
    """Return a zip whose headers say that 20 MB are 20 bytes."""
    data = bytearray(zip_bytes({"work/notes.txt": bytes(20_000_000)}, {}))
    for signature, offset in ((b"PK\x03\x04", 22), (b"PK\x01\x02", 24)):
        struct.pack_into("<I", data, data.index(signature) + offset, 20)
    return bytes(data)


def _nested(depth: int) -> bytes:
    data = zip_bytes(MODEL, {})
    for _ in range(depth):
        data = zip_bytes({"inner.zip": data}, {})
    return data


def _folder_with(change: Callable[[Path], None]) -> Make:
    """Hand in the model's folder after something was done to it that files cannot say."""

    def make(folder: Path, values: Mapping[str, str]) -> Path:
        write(MODEL, folder / "work", values)
        change(folder / "work")
        return folder / "work"

    return make


def _sparse(work: Path) -> None:
    with (work / "sparse.bin").open("wb") as file:
        file.truncate(1 << 36)


def _pipe(work: Path) -> None:
    os.mkfifo(work / "pipe.py")
    os.mkfifo(work / P / "README.md")


def _loop(work: Path) -> None:
    (work / "src" / "again").symlink_to("..")
    (work / "itself").symlink_to("itself")


def _deep(work: Path) -> None:
    folder = work
    for _ in range(60):
        folder /= "down"
    folder.mkdir(parents=True)
    (folder / "here.py").write_text("import rclpy\n")


def _model(*changes: Change) -> Make:
    return as_folder(made(MODEL, *changes))


_ENTITIES = (
    '<?xml version="1.0"?>\n<!DOCTYPE package [<!ENTITY a "aaaaaaaaaaaaaaaa">'
    + "".join(
        f'<!ENTITY {name} "{f"&{before};" * 16}">' for before, name in zip("abcdefg", "bcdefgh", strict=True)
    )
    + "]>\n"
)
_FILE_ENTITY = '<?xml version="1.0"?>\n<!DOCTYPE package [<!ENTITY secret SYSTEM "file://@SECRET_FILE@">]>\n'
_DECLARATION, _DESCRIPTION = (
    '<?xml version="1.0"?>\n',
    "Status, commands and velocity of a small robot, homework of week two.",
)
_ALIASES = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{name}: &{name} [{', '.join([f'*{before}'] * 9)}]\n"
    for before, name in zip("abcdefgh", "bcdefghi", strict=True)
)
_OBJECT = "status_publisher:\n  ros__parameters:\n    timer_period: !!python/object/apply:os.system ['touch /tmp/@TOKEN@']\n"

LEADING_OUT: tuple[Case, ...] = (
    packed(
        "zip_traversal", "a member whose name goes up", _zip_with((_OUT, "x"), ("src/../../../@TOKEN@", "x"))
    ),
    packed(
        "zip_absolute",
        "a member with an absolute name",
        _zip_with(("/tmp/@TOKEN@", "x"), ("C:\\@TOKEN@", "x")),
    ),
    packed("zip_backslashes", "a name that goes up on Windows", _zip_with(("..\\..\\..\\@TOKEN@", "x"))),
    packed(
        "zip_through_link",
        "a link to /tmp, and a member below it",
        as_zip({**MODEL, "src/out": Link("/tmp")}),
    ),
    _tar("traversal", "a member whose name goes up", _member(_OUT, data=b"x")),
    _tar("absolute", "a member with an absolute name", _member("/tmp/@TOKEN@", data=b"x")),
    _tar(
        "through_link",
        "a link to /tmp, and a member below it",
        _member("out", tarfile.SYMTYPE, "/tmp"),
        _member("out/@TOKEN@", data=b"x"),
    ),
    _tar(
        "link_to_report",
        "a link to a file of the host, and a member that writes to it",
        _member("out", tarfile.SYMTYPE, "@CANARY@"),
        _member("out", data=b"owned"),
    ),
    _tar(
        "hard_link",
        "a hard link to a file of the host, and a member that writes to it",
        _member("out", tarfile.LNKTYPE, "@CANARY@"),
        _member("out", data=b"owned"),
    ),
    _tar(
        "hard_link_to_secret",
        "a README that is a hard link to a key",
        _member("README.txt", tarfile.LNKTYPE, "@SECRET_FILE@"),
    ),
    _tar(
        "devices",
        "devices and a pipe",
        _member("random", tarfile.CHRTYPE),
        _member("disk", tarfile.BLKTYPE),
        _member("README.txt", tarfile.FIFOTYPE),
    ),
    packed(
        "link_to_secret",
        "README and a module are links to a key",
        _model(put(README, Link("@SECRET_FILE@")), put(f"{M}key.py", Link("@SECRET_FILE@"))),
    ),
    packed(
        "link_to_root",
        "links to / and to /proc",
        _model(put("src/everything", Link("/")), put(f"{P}config/proc", Link("/proc/self"))),
    ),
    packed("link_loops", "links that lead back to themselves", _folder_with(_loop)),
)

TOO_MUCH: tuple[Case, ...] = (
    packed(
        "zip_bomb", "half a megabyte that becomes 520", _file("work.zip", _zip_bomb), most=0, is_refused=True
    ),
    packed("zip_many", "thirty thousand members", _file("work.zip", _many_members), most=0, is_refused=True),
    packed(
        "zip_liar", "headers that say 20 bytes of 20 MB", _file("work.zip", _liar), most=0, is_refused=True
    ),
    packed("zip_nested", "a zip in a zip, twelve times", _file("work.zip", lambda: _nested(12)), most=0),
    packed("zip_encrypted", "a zip with a password", _file("work.zip", _encrypted), most=0, is_refused=True),
    packed("sparse_file", "a file of 64 GB that holds nothing", _folder_with(_sparse)),
    packed("pipes", "pipes that nobody writes to, one of them the README", _folder_with(_pipe)),
    packed("deep_folders", "sixty folders inside one another", _folder_with(_deep)),
    packed("long_readme", "a README of 8 MB", _model(put(README, "ros2 run " * 900_000))),
    packed(
        "long_module",
        "a module of 3 MB",
        _model(put(f"{M}table.py", "TABLE = [\n" + "    1,\n" * 430_000 + "]\n")),
    ),
)

UNREADABLE: tuple[Case, ...] = (
    packed(
        "xml_entities",
        "entities that become gigabytes",
        _model(edit(XML, _DECLARATION, _ENTITIES), edit(XML, _DESCRIPTION, "&h;")),
    ),
    packed(
        "xml_reads_secret",
        "an entity that is a key file",
        _model(edit(XML, _DECLARATION, _FILE_ENTITY), edit(XML, _DESCRIPTION, "&secret;")),
    ),
    packed("yaml_aliases", "a parameter file that becomes gigabytes", _model(put(YAML, _ALIASES))),
    packed("yaml_object", "a parameter file that calls a function", _model(put(YAML, _OBJECT))),
    packed(
        "deep_expression",
        "brackets in brackets, more than a parser bears",
        _model(put(f"{M}deep.py", "X = " + "(" * 5000 + ")" * 5000 + "\n")),
        unreadable=("/deep.py",),
    ),
    packed(
        "null_bytes",
        "a module with null bytes",
        _model(put(f"{M}null.py", b"import rclpy\n\0\0\0\n")),
        unreadable=("/null.py",),
    ),
    packed(
        "not_text",
        "a node in an encoding that does not exist",
        _model(edit(STATUS, '"""A node', '# -*- coding: klingon -*-\n"""A node')),
        unreadable=("/status_publisher.py",),
    ),
)
