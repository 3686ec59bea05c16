"""A submission's files as data, changes to them, and the ways to hand them in."""

from __future__ import annotations

import io
import tarfile
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from corpus.case import Make


@dataclass(frozen=True)
class Link:
    """A symbolic link."""

    target: str


Content = str | bytes | Link
Files = dict[str, Content]  # by path
Change = Callable[[Files], None]


def made(base: Mapping[str, Content], *changes: Change) -> Files:
    """Return the files after the changes; the base stays as it is."""
    files = dict(base)
    for change in changes:
        change(files)
    return files


def edit(path: str, old: str, new: str) -> Change:
    """Replace a text that stands in a file exactly once.

    Raises:
        ValueError: when the change is made, if it does not.
    """

    def change(files: Files) -> None:
        text = files[path]
        if not isinstance(text, str) or text.count(old) != 1:
            raise ValueError(f"{old!r} must stand in {path} exactly once.")
        files[path] = text.replace(old, new)

    return change


def put(path: str, content: Content) -> Change:
    """Write a file, also over one that is there."""
    return lambda files: files.update({path: content})


def drop(*starts: str) -> Change:
    """Take away all files whose path begins so; there must be one."""

    def change(files: Files) -> None:
        for start in starts:
            gone = [path for path in files if path.startswith(start)]
            if not gone:
                raise ValueError(f"There is no {start} to drop.")
            for path in gone:
                del files[path]

    return change


def move(old: str, new: str) -> Change:
    """Move what begins with a path; there must be something."""

    def change(files: Files) -> None:
        moved = {path: content for path, content in files.items() if path.startswith(old)}
        if not moved:
            raise ValueError(f"There is no {old} to move.")
        for path in moved:
            del files[path]
        files.update({new + path.removeprefix(old): content for path, content in moved.items()})

    return change


def every(change: Callable[[str], str], *endings: str) -> Change:
    """Change the text of every file that ends so."""

    def changed(files: Files) -> None:
        for path, content in files.items():
            if isinstance(content, str) and path.endswith(endings):
                files[path] = change(content)

    return changed


def filled(content: Content, values: Mapping[str, str]) -> Content:
    """Put values in place of `@NAME@`."""
    if isinstance(content, bytes):
        return content
    text = content.target if isinstance(content, Link) else content
    for name, value in values.items():
        text = text.replace(f"@{name}@", value)
    return Link(text) if isinstance(content, Link) else text


def write(files: Mapping[str, Content], folder: Path, values: Mapping[str, str]) -> None:
    """Write files below a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, raw in files.items():
        path, content = folder / name, filled(raw, values)
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, Link):
            path.symlink_to(content.target)
        else:
            path.write_bytes(content.encode() if isinstance(content, str) else content)


# --- ways to hand in --------------------------------------------------------------------------------------


def as_folder(files: Mapping[str, Content], name: str = "robot_project_ws") -> Make:
    """Hand in a folder."""

    def make(folder: Path, values: Mapping[str, str]) -> Path:
        write(files, folder / name, values)
        return folder / name

    return make


def zip_bytes(files: Mapping[str, Content], values: Mapping[str, str]) -> bytes:
    """Return a zip; links in it are links."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, raw in files.items():
            content = filled(raw, values)
            info = zipfile.ZipInfo(name)
            info.compress_type = zipfile.ZIP_DEFLATED
            is_link = isinstance(content, Link)
            info.create_system, info.external_attr = 3, (0o120777 if is_link else 0o100644) << 16
            archive.writestr(info, content.target if isinstance(content, Link) else content)
    return buffer.getvalue()


def as_zip(files: Mapping[str, Content], name: str = "robot_project_ws.zip", depth: int = 1) -> Make:
    """Hand in a zip, or with `depth` 2 a zip in a zip."""

    def make(folder: Path, values: Mapping[str, str]) -> Path:
        data = zip_bytes(files, values)
        for _ in range(depth - 1):
            data = zip_bytes({name: data}, {})
        folder.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)
        return folder / name

    return make


def as_tar(
    files: Mapping[str, Content],
    *members: tuple[tarfile.TarInfo, bytes],
    name: str = "robot_project_ws.tar.gz",
) -> Make:
    """Hand in a tar of the files and further members, which may be anything."""

    def make(folder: Path, values: Mapping[str, str]) -> Path:
        folder.mkdir(parents=True, exist_ok=True)
        with tarfile.open(folder / name, "w:gz") as archive:
            for path, raw in files.items():
                content = filled(raw, values)
                info = tarfile.TarInfo(path)
                if isinstance(content, Link):
                    info.type, info.linkname = tarfile.SYMTYPE, content.target
                    archive.addfile(info)
                    continue
                data = content.encode() if isinstance(content, str) else content
                info.size, info.mode = len(data), 0o644
                archive.addfile(info, io.BytesIO(data))
            for member, data in members:
                info = tarfile.TarInfo(str(filled(member.name, values)))
                info.type, info.mode, info.size = member.type, member.mode, len(data)
                info.linkname = str(filled(member.linkname, values))
                info.devmajor, info.devminor = member.devmajor, member.devminor
                archive.addfile(info, io.BytesIO(data))
        return folder / name

    return make
