"""What was handed in, and by whom: a row of the class before anything of it is opened."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path

from ros2lab.grading.senses import seen

_ARCHIVE = re.compile(r"\.(zip|tar|tgz|tar\.\w+|tbz2?|txz)$", re.IGNORECASE)


class ClassError(Exception):
    """A class that cannot be graded as asked for; the message is one sentence that says what to do."""


@dataclass(frozen=True)
class HandedIn:
    """One submission of one student.

    Attributes:
        key: tells the student from all others of the class: the platform's id, or the name.
        name: as far as it is known.
        student_id: as the platform has it; empty if it does not say.
        email: empty if it is not known.
        paths: the folder or archive, or the loose files of the submission.
        attempt: counts from 1.
        is_late: whether the platform says so.
        upload: orders what has the same attempt; the higher, the later.
        label: how the platform calls the row, by which it takes feedback back.
        reason: why it cannot be graded, in a sentence; empty if it can.
        notes: what an instructor should know, a sentence each.
        is_unsure: whether the name can be read as that of somebody else's, too.
    """

    key: str
    name: str
    student_id: str = ""
    email: str = ""
    paths: tuple[Path, ...] = ()
    attempt: int = 1
    is_late: bool = False
    upload: int = 0
    label: str = ""
    reason: str = ""
    notes: tuple[str, ...] = ()
    is_unsure: bool = False


def is_archive(path: Path) -> bool:
    """Return whether a file is called as an archive is."""
    return bool(_ARCHIVE.search(path.name))


def latest(found: Iterable[HandedIn], *, is_one_each: bool = False) -> list[HandedIn]:
    """Return one row for each student, in the order of their keys: what counts of all that came from them.

    Nobody's work is taken for an earlier attempt of somebody else: what came with one key under several names is a row
    for each of these. Of several attempts it is the last; in one attempt archives and folders come before loose files, and the last
    upload before earlier ones. Loose files of one attempt belong together.

    Args:
        found: all that was handed in.
        is_one_each: whether the platform gives the last attempt of each only, so that each archive is a row.
    """
    ordered = sorted(found, key=lambda row: (row.key, row.name, row.is_unsure, row.attempt, row.upload))
    counting = [
        row
        for _, rows in groupby(ordered, key=lambda row: (row.key, row.name, row.is_unsure))
        for row in _counting([*rows], is_one_each=is_one_each)
    ]
    return [
        _as_text(row)
        for _, rows in groupby(counting, key=lambda row: row.key)
        for row in _told_apart([*rows])
    ]


def _told_apart(rows: list[HandedIn]) -> Iterator[HandedIn]:
    """Yield what came with one key; each with a key of its own if it came under several names."""
    if len(rows) == 1:
        yield from rows
        return
    known = Counter(row.name for row in rows)
    called = [
        row.paths[0].name if row.paths and (row.is_unsure or known[row.name] > 1) else row.name
        for row in rows
    ]
    for row, name in zip(rows, called, strict=True):
        others = ", ".join(other for other in called if other != name)
        note = f"{row.key} came with {others}, too; decide yourself whose each of them is."
        yield replace(row, key=f"{row.key} ({name})", notes=(*row.notes, note))


def _as_text(row: HandedIn) -> HandedIn:
    """Return a row whose texts are valid, also where names of files are not."""
    names = ("key", "name", "student_id", "email", "label", "reason")
    texts = {name: getattr(row, name).encode(errors="backslashreplace").decode() for name in names}
    notes = tuple(note.encode(errors="backslashreplace").decode() for note in row.notes)
    return replace(row, **texts, notes=notes)


def _counting(rows: list[HandedIn], *, is_one_each: bool) -> Iterator[HandedIn]:
    """Yield what counts of one student's."""
    gradable = [row for row in rows if not row.reason] or rows
    last = [row for row in gradable if row.attempt == gradable[-1].attempt]
    whole = [row for row in last if any(path.is_dir() or is_archive(path) for path in row.paths)]
    chosen = (whole if is_one_each else whole[-1:]) or last[-1:]
    if not whole:
        chosen = [replace(chosen[0], paths=tuple(path for row in last for path in row.paths))]
    used = {path for row in chosen for path in row.paths}
    left_out = [path.name for row in rows for path in row.paths if path not in used]
    for one in chosen:
        alike = last if len(chosen) == 1 else [one]
        notes = [*dict.fromkeys(note for row in alike for note in row.notes), *_notes(left_out)]
        if one.is_unsure:
            notes.append("What it is called can be read as somebody else's, too; look whose it is.")
        yield replace(one, is_late=any(row.is_late for row in alike), notes=tuple(notes))


def _notes(left_out: list[str]) -> Iterator[str]:
    if left_out:
        yield f"Not graded, for something else of the same student counts: {', '.join(left_out)}."


def named_by(word: str, rows: Iterable[HandedIn]) -> list[HandedIn]:
    """Return whom a word names: by the key, the id, the address or the whole name, else by a part of the name.

    What looks alike is the same, whatever its capitals, its spaces, and how its letters are composed.
    """
    rows, meant = [*rows], as_one_name(seen(word))
    whole = [
        row
        for row in rows
        if meant in (as_one_name(seen(text)) for text in (row.key, row.student_id, row.email, row.name))
    ]
    return (whole or [row for row in rows if meant in as_one_name(seen(row.name))]) if meant else []


def called(rows: Iterable[HandedIn]) -> dict[str, str]:
    """Return how each row is named, by its key: with the key in brackets where the name may be read as another's.

    That is where two names look the same, and where one ends in brackets, as if with a key.
    """
    rows = [*rows]
    names = Counter(as_one_name(seen(row.name)) for row in rows)
    keys = Counter(as_one_name(seen(row.key)) for row in rows)
    found = dict[str, str]()
    for row in rows:
        key = row.key if keys[as_one_name(seen(row.key))] == 1 else ascii(row.key)
        is_open = names[as_one_name(seen(row.name))] > 1 or seen(row.name).endswith(")")
        found[row.key] = f"{row.name} ({key})" if is_open else row.name
    return found


def as_one_name(name: str) -> str:
    """Return what is the same for names that are one file on some system: of other capitals, or another form of Unicode."""
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())
