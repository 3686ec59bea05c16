"""Find what a class has handed in: folders and archives, a platform's download, nbgrader's tree, or a CSV."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml

from ros2lab.assignments.lesson import load_lesson
from ros2lab.classroom import identity, names, roster
from ros2lab.classroom.handed_in import ClassError, HandedIn, is_archive, latest

METADATA = "submission_metadata.yml"
SUBMITTED = "submitted"
TIMESTAMP = "timestamp.txt"
_OF_A_SYSTEM = ("__MACOSX", "Thumbs.db", "desktop.ini")

Read = Callable[[Path], "list[HandedIn] | None"]


def find(path: Path, received: Path, form: str = "") -> list[HandedIn]:
    """Return one row for each student, what counts of all that came from them; nothing of it is opened.

    Args:
        path: a folder, a zip of a platform, or a CSV.
        received: a folder of ours, for what is unpacked or cloned.
        form: one of `FORMS`; empty finds it out.

    Raises:
        ClassError: if nothing can be found there.
    """
    if path.suffix.lower() == ".csv":
        return latest(roster.read(path, received))
    if zipfile.is_zipfile(path):
        path = _unpacked(path, received / path.stem)
    if not path.is_dir():
        raise ClassError(f"{path} is no folder, zip or CSV of submissions; give one of them.")
    readers = [FORMS[form]] if form else [*FORMS.values()]
    for read in readers:
        found = read(path)
        if found:
            return latest(found, is_one_each=read is _canvas)
    raise ClassError(
        f"There are no submissions in {path}{f' as {form} has them' if form else ''}; give a folder with one "
        "folder or archive for each student."
    )


def _entries(folder: Path) -> list[Path]:
    return sorted(
        path for path in folder.iterdir() if not path.name.startswith(".") and path.name not in _OF_A_SYSTEM
    )


def _not_followed(row: HandedIn, *places: Path) -> HandedIn:
    """Return a row with a reason if one of its places is a link: what that leads to was not handed in there."""
    link = next((place for place in places if place.is_symlink()), None)
    if link is None:
        return row
    reason = f"{link.name} is a link to {link.readlink()}, and no link is followed; put the files themselves there."
    return replace(row, paths=(), reason=reason)


def _mostly(folder: Path, read: Callable[[Path], HandedIn | None]) -> list[HandedIn] | None:
    """Return the rows of a folder whose names are mostly of one form; what has another name is a row by itself."""
    entries = _entries(folder)
    rows = {path: read(path) for path in entries}
    if sum(row is not None for row in rows.values()) * 2 <= len(entries):
        return None
    return [_not_followed(row, path) if row else _plain(path) for path, row in rows.items()]


def _canvas(folder: Path) -> list[HandedIn] | None:
    return _mostly(folder, names.canvas)


def _moodle(folder: Path) -> list[HandedIn] | None:
    rows = _mostly(folder, names.moodle)
    files = {(row.key, row.name) for row in rows or () if not row.reason and not row.is_unsure}
    # Beside a file, what was typed is no submission of its own.
    return [
        row for row in rows or () if not row.reason or row.is_unsure or (row.key, row.name) not in files
    ] or None


def _gradescope(folder: Path) -> list[HandedIn] | None:
    described: Mapping[str, Any] = {}
    # What lies beside others is what a student has handed in, and may be called as anything.
    entries = _entries(folder)
    if len(entries) == 1 and (entries[0] / METADATA).is_file():
        folder = entries[0]
    if not (folder / METADATA).is_file():
        return None
    try:
        described = yaml.safe_load((folder / METADATA).read_text(encoding="utf-8")) or {}
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ClassError(
            f"{folder / METADATA} cannot be read ({error}); export the submissions again."
        ) from None
    rows: list[HandedIn] = []
    for path in _entries(folder):
        about = described.get(path.name) if isinstance(described, Mapping) else None
        found = names.gradescope(path, about if isinstance(about, Mapping) else {})
        if path.name != METADATA:
            rows += [_not_followed(row, path) for row in found or [_plain(path)]]
    return rows


def _nbgrader(folder: Path) -> list[HandedIn] | None:
    tree = folder / SUBMITTED if (folder / SUBMITTED).is_dir() else folder
    if tree.name != SUBMITTED:
        return None
    students = [path for path in _entries(tree) if path.is_dir() or path.is_symlink()]
    own = [student for student in students if not student.is_symlink()]
    assignments = {path.name for student in own for path in _entries(student) if path.is_dir()}
    if len(assignments) > 1:
        raise ClassError(
            f"{tree} holds several assignments ({', '.join(sorted(assignments))}); give a folder in which "
            f"{SUBMITTED} has only the one that is to be graded."
        )
    return [row for student in students for row in _handed_to_nbgrader(student)]


def _handed_to_nbgrader(student: Path) -> Iterator[HandedIn]:
    row = HandedIn(student.name, student.name, student.name, label=student.name)
    if student.is_symlink():
        yield _not_followed(row, student)
        return
    paths = [path for path in _entries(student) if path.is_dir() or path.is_symlink()]
    for path in paths:
        yield _not_followed(replace(row, paths=(project_in(path),)), path)
    if not paths:
        yield replace(row, reason="Nothing was handed in.")


def project_in(folder: Path) -> Path:
    """Return the project's workspace in a folder of notebooks; the folder itself where there is none.

    The lessons leave other workspaces beside it.
    """
    name = load_lesson().workspace
    for inside in (Path(name), Path("work", name)):
        path = folder / inside
        is_own = path.resolve() == folder.resolve() / inside  # a link on the way may lead to somebody else's
        if is_own and path.is_dir() and any(file.name == "package.xml" for _, file in identity.files(path)):
            return path
    return folder


def _plainly(folder: Path) -> list[HandedIn]:
    return [_plain(path) for path in _entries(folder)]


def _plain(path: Path) -> HandedIn:
    name = path.name
    while is_archive(path) and Path(name).suffix:
        name = Path(name).stem
        if not is_archive(Path(name)):
            break
    return _not_followed(HandedIn(name, name, paths=(path,), label=name), path)


# By what a folder holds; the first that fits is taken.
FORMS: Mapping[str, Read] = {
    "nbgrader": _nbgrader,
    "gradescope": _gradescope,
    "moodle": _moodle,
    "canvas": _canvas,
    "folder": _plainly,
}


def _unpacked(archive: Path, folder: Path) -> Path:
    """Unpack a platform's zip of all submissions; each of these stays packed."""
    part = folder.with_name(f".{folder.name}.part")
    shutil.rmtree(part, ignore_errors=True)
    try:
        with zipfile.ZipFile(archive) as opened:
            opened.extractall(part)
    except (OSError, RuntimeError, NotImplementedError, zipfile.BadZipFile) as error:
        raise ClassError(f"{archive} cannot be unpacked ({error}); download it again.") from None
    shutil.rmtree(folder, ignore_errors=True)
    part.replace(folder)
    inner = _entries(folder)
    return inner[0] if len(inner) == 1 and inner[0].is_dir() and not is_archive(inner[0]) else folder


def chosen(rows: Iterable[HandedIn], words: Iterable[str]) -> list[HandedIn]:
    """Return the rows that words name: by key, id, email, or a part of the name.

    Raises:
        ClassError: if a word names none.
    """
    rows, found = [*rows], dict[str, HandedIn]()
    for word in words:
        exact = [row for row in rows if word in (row.key, row.student_id, row.email, row.name)]
        named = exact or [row for row in rows if word.casefold() in row.name.casefold()]
        if not named:
            raise ClassError(
                f"Nobody in this class is called {word!r}; give a name, an id or an email address."
            )
        found.update({row.key: row for row in named})
    return [row for row in rows if row.key in found]
