"""Find what a class has handed in: folders and archives, a platform's download, nbgrader's tree, or a CSV."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import yaml

from ros2lab.assignments.lesson import load_lesson
from ros2lab.classroom import identity, names, roster
from ros2lab.classroom.handed_in import ClassError, HandedIn, is_archive, latest, named_by

METADATA = "submission_metadata.yml"
SUBMITTED = "submitted"
# What nbgrader has beside that; what else lies there may be a hand-in, if it is a folder or an archive.
_OF_NBGRADER = ("source", "release", "autograded", "feedback", "gradebook.db", "nbgrader_config.py")
_OF_A_SYSTEM = ("__MACOSX", "Thumbs.db", "desktop.ini")

Read = Callable[[Path], "list[HandedIn] | None"]


def find(
    path: Path, received: Path, form: str = "", pass_over: Callable[[list[str]], None] = lambda _: None
) -> list[HandedIn]:
    """Return one row for each student, what counts of all that came from them; nothing of it is opened.

    No hand-in decides how the others are read, whatever it is called or holds.

    Args:
        path: a folder, a zip of a platform, or a CSV.
        received: a folder of ours, for what is unpacked or cloned.
        form: one of `FORMS`; empty finds it out.
        pass_over: is given the names of what lies in a folder and is taken for no hand-in.

    Raises:
        ClassError: if nothing can be found there, or it cannot be told what is a hand-in.
    """
    if path.suffix.lower() == ".csv":
        return latest(roster.read(path, received))
    if zipfile.is_zipfile(path):
        path = _unpacked(path, received / path.stem)
    if not path.is_dir():
        raise ClassError(f"{path} is no folder, zip or CSV of submissions; give one of them.")
    for name in [form] if form else FORMS:
        if not form and name == "nbgrader" and not _may_be_a_course(path):
            continue
        found = FORMS[name](path)
        if found:
            pass_over(_passed_over(path, name))
            return latest(found, is_one_each=name == "canvas")
    raise ClassError(
        f"There are no submissions in {path}{f' as {form} has them' if form else ''}; give a folder with one "
        "folder or archive for each student."
    )


def _entries(folder: Path) -> list[Path]:
    return sorted(
        path for path in folder.iterdir() if not path.name.startswith(".") and path.name not in _OF_A_SYSTEM
    )


def _passed_over(folder: Path, form: str) -> list[str]:
    tree = folder / SUBMITTED if form == "nbgrader" and (folder / SUBMITTED).is_dir() else folder
    beside = {path for path in folder.iterdir() if tree not in (folder, path)}
    return sorted(path.name for path in beside | ({*tree.iterdir()} - {*_entries(tree)}))


def _may_be_a_course(folder: Path) -> bool:
    """Return whether what is called `submitted` may be nbgrader's: a hand-in may be called so, too.

    Raises:
        ClassError: if it lies both beside what is nbgrader's and beside what may be hand-ins.
    """
    if not (folder / SUBMITTED).is_dir() or (folder / SUBMITTED).is_symlink():
        return folder.name == SUBMITTED
    beside = [path for path in _entries(folder) if path.name != SUBMITTED]
    own = [path.name for path in beside if path.name in _OF_NBGRADER]
    others = [path.name for path in beside if path.name not in own and (path.is_dir() or is_archive(path))]
    if own and others:
        raise ClassError(
            f"{folder} holds {SUBMITTED} and {own[0]}, as a course of nbgrader does, and also {', '.join(others[:5])}; "
            "say --from nbgrader if it is one, or --from folder if each of them was handed in."
        )
    return not others


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
    # What lies beside others is what a student has handed in, and may be called as anything.
    entries = _entries(folder)
    if len(entries) == 1 and (entries[0] / METADATA).is_file():
        folder = entries[0]
    entries = [path for path in _entries(folder) if path.name != METADATA]
    own = [path for path in entries if names.gradescope(path, {})]
    if not (folder / METADATA).is_file() or len(own) * 2 <= len(entries):
        return None
    try:
        # All in it is text: a name may look like a number, and a date be impossible.
        described = yaml.load((folder / METADATA).read_text(encoding="utf-8"), yaml.BaseLoader)  # noqa: S506
    except (OSError, ValueError, RecursionError, yaml.YAMLError) as error:
        raise ClassError(
            f"{folder / METADATA} cannot be read ({error}); export the submissions again."
        ) from None
    rows: list[HandedIn] = []
    for path in entries:
        about = described.get(path.name) if isinstance(described, Mapping) else None
        found = names.gradescope(path, about if isinstance(about, Mapping) else {})
        rows += [_not_followed(row, path) for row in found or [_plain(path)]]
    return rows


def _nbgrader(folder: Path) -> list[HandedIn] | None:
    tree = folder / SUBMITTED if (folder / SUBMITTED).is_dir() else folder
    if tree.name != SUBMITTED:
        return None
    students = _entries(tree)
    own = [student for student in students if student.is_dir() and not student.is_symlink()]
    assignments = {path.name for student in own for path in _entries(student) if path.is_dir()}
    if len(assignments) > 1:
        raise ClassError(
            f"{tree} holds several assignments ({', '.join(sorted(assignments))}); give a folder in which {SUBMITTED} "
            "has only the one that is to be graded, or say --from folder if each folder in it was handed in."
        )
    return [row for student in students for row in _handed_to_nbgrader(student)] if own else None


def _handed_to_nbgrader(student: Path) -> Iterator[HandedIn]:
    if student.is_symlink() or not student.is_dir():
        yield _plain(student)
        return
    row = HandedIn(student.name, student.name, student.name, label=student.name)
    paths = _entries(student)
    for path in paths:
        yield _not_followed(replace(row, paths=(project_in(path),), upload=path.is_dir()), path)
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
    notes = (f"If {name} is that of nbgrader, with all that was handed in, say --from nbgrader.",)
    row = HandedIn(name, name, paths=(path,), label=name, notes=notes if path.name == SUBMITTED else ())
    return _not_followed(row, path)


# By what a folder holds; the first that fits is taken.
FORMS: Mapping[str, Read] = {
    "gradescope": _gradescope,
    "moodle": _moodle,
    "canvas": _canvas,
    "nbgrader": _nbgrader,
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
    """Return the rows that words name; see `named_by`.

    Raises:
        ClassError: if a word names none.
    """
    rows, found = [*rows], dict[str, HandedIn]()
    for word in words:
        named = named_by(word, rows)
        if not named:
            raise ClassError(
                f"Nobody in this class is called {word!r}; give a name, an id or an email address."
            )
        found.update({row.key: row for row in named})
    return [row for row in rows if row.key in found]
