"""The gradebook: a SQLite file that holds a class, what was seen of it, and what it is worth.

Each submission is written in one transaction, and what was written stays, also if the power goes. The schema's
version is `PRAGMA user_version`; a gradebook of an older release is brought up to date when it is opened, in one
transaction, and one of a newer release is refused. docs/instructors.md describes the tables.
"""

from __future__ import annotations

import fcntl
import json
import os
import sqlite3
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path
from typing import Any, Literal

from ros2lab.classroom.handed_in import ClassError, HandedIn
from ros2lab.scratch import scratch_folder

NAME = "gradebook.sqlite"
APPLICATION = 0x5232_4C42  # "R2LB"

# What leads from each version of the schema to the next one. A released entry is never changed.
MIGRATIONS: tuple[tuple[str, ...], ...] = (
    (
        """CREATE TABLE submission (
            student TEXT PRIMARY KEY,     -- tells a student from all others
            name TEXT NOT NULL,
            student_id TEXT NOT NULL,
            email TEXT NOT NULL,
            label TEXT NOT NULL,          -- how the platform calls the row
            paths TEXT NOT NULL,          -- JSON
            attempt INTEGER NOT NULL,
            is_late INTEGER NOT NULL,
            notes TEXT NOT NULL,          -- JSON: what an instructor should know
            digest TEXT NOT NULL,         -- of all that was handed in; empty if it cannot be read
            handed_in_at INTEGER NOT NULL,
            state TEXT NOT NULL CHECK (state IN ('waiting', 'graded', 'failed', 'unreadable')),
            reason TEXT NOT NULL          -- of a state that is not `graded`
        )""",
        """CREATE TABLE grading (
            id INTEGER PRIMARY KEY,
            digest TEXT NOT NULL,
            assignment TEXT NOT NULL,     -- digest of what was asked for
            grader TEXT NOT NULL,         -- digest of the program that graded
            evidence BLOB NOT NULL,       -- zlib of JSON
            sources BLOB NOT NULL,        -- zlib of JSON: Python files by path
            problem TEXT NOT NULL,        -- why there was nothing to grade
            seconds REAL NOT NULL,
            graded_at TEXT NOT NULL,
            UNIQUE (digest, assignment, grader)
        )""",
        """CREATE TABLE grade (
            student TEXT PRIMARY KEY REFERENCES submission (student),
            grading INTEGER NOT NULL REFERENCES grading (id),
            rubric TEXT NOT NULL,         -- digest of what the points were given for
            total REAL NOT NULL,
            max REAL NOT NULL,
            data BLOB NOT NULL            -- zlib of JSON, as `ros2lab grade --json`
        )""",
        """CREATE TABLE decision (
            student TEXT NOT NULL,
            criterion TEXT NOT NULL,
            points REAL NOT NULL,
            comment TEXT NOT NULL,
            decided_by TEXT NOT NULL,
            decided_at TEXT NOT NULL,
            PRIMARY KEY (student, criterion)
        )""",
    ),
)

State = Literal["waiting", "graded", "failed", "unreadable"]


@dataclass(frozen=True)
class Seen:
    """What a grading has brought to light.

    Attributes:
        evidence: as JSON.
        sources: Python files by path.
        problem: why there was nothing to grade; empty if there was.
        seconds: how long it took.
    """

    evidence: str
    sources: Mapping[str, str]
    problem: str
    seconds: float


@dataclass(frozen=True)
class Worth:
    """What a student's submission is worth: the grade as JSON, and by which rubric."""

    total: float
    max: float
    data: str
    rubric: str


@dataclass(frozen=True)
class Row:
    """A student's row.

    Attributes:
        handed: what was handed in.
        digest: of it.
        state: of its grading.
        reason: of a state that is not `graded`.
        worth: None if there is no grade.
        grading: the number of the grading on which the grade rests; 0 if there is none.
        problem: why there was nothing to grade; empty if there was.
        seconds: how long it took.
    """

    handed: HandedIn
    digest: str
    state: State
    reason: str
    worth: Worth | None
    grading: int
    problem: str
    seconds: float


@contextmanager
def opened(folder: Path, *, is_new_allowed: bool = False) -> Iterator[Gradebook]:
    """Open the gradebook of a folder, alone.

    Raises:
        ClassError: if there is none, another command has it open, or it is not one that this release can read.
    """
    path = folder / NAME
    if not path.is_file() and not is_new_allowed:
        raise ClassError(
            f"There is no gradebook in {folder}; make one with `ros2lab class grade SUBMISSIONS`."
        )
    folder.mkdir(parents=True, exist_ok=True)
    lock = os.open(folder / f".{NAME}.lock", os.O_RDWR | os.O_CREAT, 0o600)
    try:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise ClassError(f"Another command works with {path}; wait until it has ended.") from None
        connection = sqlite3.connect(path, isolation_level=None)
        try:
            yield Gradebook(connection, path)
        finally:
            with suppress(sqlite3.Error):
                connection.close()
    finally:
        os.close(lock)


@contextmanager
def copied(folder: Path) -> Iterator[Path]:
    """Give a folder with a copy of another one's gradebook, if it has one: what is done in it changes nothing."""
    with scratch_folder() as scratch:
        if (folder / NAME).is_file():
            with (
                closing(sqlite3.connect(folder / NAME)) as book,
                closing(sqlite3.connect(Path(scratch, NAME))) as copy,
            ):
                book.backup(copy)
        yield Path(scratch)


class Gradebook:
    """The gradebook while it is open; made by `opened`."""

    def __init__(self, connection: sqlite3.Connection, path: Path) -> None:
        self._sql = connection
        try:
            self._prepare(path)
        except sqlite3.DatabaseError as error:
            raise ClassError(f"{path} is no gradebook ({error}); give another folder with --out.") from None

    def _prepare(self, path: Path) -> None:
        (version,) = self._sql.execute("PRAGMA user_version").fetchone()
        (owner,) = self._sql.execute("PRAGMA application_id").fetchone()
        if version > len(MIGRATIONS):
            raise ClassError(
                f"{path} was made by a newer ros2lab (schema {version}, not {len(MIGRATIONS)}); install that one."
            )
        if owner not in (0, APPLICATION) or (
            owner == 0 and self._sql.execute("SELECT * FROM sqlite_master").fetchone()
        ):
            raise ClassError(f"{path} is the database of another program; give another folder.")
        self._sql.execute("PRAGMA journal_mode = WAL")
        self._sql.execute("PRAGMA synchronous = FULL")
        self._sql.execute("PRAGMA foreign_keys = ON")
        if version < len(MIGRATIONS):
            with self._transaction():
                for statements in MIGRATIONS[version:]:
                    for statement in statements:
                        self._sql.execute(statement)
                self._sql.execute(f"PRAGMA application_id = {APPLICATION}")
                self._sql.execute(f"PRAGMA user_version = {len(MIGRATIONS)}")

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        self._sql.execute("BEGIN IMMEDIATE")
        try:
            yield
        except BaseException:
            with suppress(sqlite3.Error):  # a full disk has rolled it back already
                self._sql.execute("ROLLBACK")
            raise
        self._sql.execute("COMMIT")

    # --- writing ------------------------------------------------------------------------------------------

    def register(self, found: Iterable[tuple[HandedIn, str, int]]) -> None:
        """Note who has handed in what: each with its digest, and when it was written.

        A grade stays as long as its submission is the same.
        """
        with self._transaction():
            for handed, digest, written_at in found:
                key = _storable(handed.key)
                before = self._sql.execute(
                    "SELECT digest, state, reason FROM submission WHERE student = ?", (key,)
                ).fetchone()
                state, reason = ("unreadable", handed.reason) if handed.reason else ("waiting", "")
                if before and before[0] == digest and not handed.reason:
                    state, reason = before[1:] if before[1] != "unreadable" else (state, reason)
                if state in ("waiting", "unreadable"):
                    self._sql.execute("DELETE FROM grade WHERE student = ?", (key,))
                values = (
                    key,
                    handed.name,
                    handed.student_id,
                    handed.email,
                    handed.label,
                    json.dumps([os.fsencode(path).decode("latin-1") for path in handed.paths]),
                    handed.attempt,
                    handed.is_late,
                    json.dumps(handed.notes),
                    digest,
                    written_at,
                    state,
                    reason,
                )
                self._sql.execute(
                    f"INSERT OR REPLACE INTO submission VALUES ({', '.join('?' * len(values))})",  # noqa: S608
                    tuple(map(_storable, values)),
                )

    def record(
        self, digest: str, assignment: str, grader: str, seen: Seen, worths: Mapping[str, Worth | str]
    ) -> None:
        """Write what was seen of a submission, and what it is worth, in one transaction.

        Args:
            digest: of the submission.
            assignment: digest of what was asked for.
            grader: digest of what graded.
            seen: what was seen.
            worths: by student, for all who have handed it in; a sentence where the evidence could not be judged.
        """
        with self._transaction():
            number = self._sql.execute(
                "INSERT INTO grading (digest, assignment, grader, evidence, sources, problem, seconds, graded_at)"
                " VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                (
                    digest,
                    assignment,
                    grader,
                    _packed(seen.evidence),
                    _packed(json.dumps(dict(seen.sources))),
                    _storable(seen.problem),
                    seen.seconds,
                    _now(),
                ),
            ).lastrowid
            self._give(int(number or 0), worths)

    def judge(self, worths: Mapping[int, Mapping[str, Worth | str]]) -> None:
        """Write what submissions are worth, by grading and student, in one transaction: all or nothing."""
        with self._transaction():
            for number, given in worths.items():
                self._give(number, given)

    def _give(self, number: int, worths: Mapping[str, Worth | str]) -> None:
        for student, worth in worths.items():
            if isinstance(worth, str):
                self._fail(student, worth)
                continue
            self._sql.execute(
                "INSERT OR REPLACE INTO grade VALUES (?, ?, ?, ?, ?, ?)",
                (student, number, worth.rubric, worth.total, worth.max, _packed(worth.data)),
            )
            self._sql.execute(
                "UPDATE submission SET state = 'graded', reason = '' WHERE student = ?", (student,)
            )

    def fail(self, students: Iterable[str], reason: str) -> None:
        """Note that the grader has failed, which is no fault of the submission."""
        with self._transaction():
            for student in students:
                self._fail(student, reason)

    def _fail(self, student: str, reason: str) -> None:
        self._sql.execute("DELETE FROM grade WHERE student = ?", (student,))
        self._sql.execute(
            "UPDATE submission SET state = 'failed', reason = ? WHERE student = ?",
            (_storable(reason), student),
        )

    def decide(self, decisions: Iterable[tuple[str, str, float, str, str]]) -> None:
        """Note decisions, all or none: student, criterion, points, comment, and by whom."""
        with self._transaction():
            for decision in decisions:
                self._sql.execute(
                    "INSERT OR REPLACE INTO decision VALUES (?, ?, ?, ?, ?, ?)",
                    (*map(_storable, decision), _now()),
                )

    def withdraw(self, student: str, criterion: str) -> bool:
        """Take a decision back, and return whether there was one."""
        with self._transaction():
            done = self._sql.execute(
                "DELETE FROM decision WHERE student = ? AND criterion = ?", (student, criterion)
            )
        return done.rowcount > 0

    # --- reading ------------------------------------------------------------------------------------------

    def rows(self) -> list[Row]:
        """Return all students in the order of their names."""
        rows = self._sql.execute(
            "SELECT s.student, s.name, s.student_id, s.email, s.label, s.paths, s.attempt, s.is_late, s.notes,"
            " s.digest, s.state, s.reason, g.grading, g.total, g.max, g.data, g.rubric, p.problem, p.seconds"
            " FROM submission s LEFT JOIN grade g USING (student) LEFT JOIN grading p ON p.id = g.grading"
            " ORDER BY lower(s.name), s.student"
        )
        return [_row(values) for values in rows]

    def graded_before(self, assignment: str, grader: str) -> dict[str, int]:
        """Return the numbers of the gradings that need not be made again, by the digest of the submission."""
        return dict(
            self._sql.execute(
                "SELECT digest, id FROM grading WHERE assignment = ? AND grader = ?", (assignment, grader)
            )
        )

    def current(self, assignment: str, grader: str) -> set[str]:
        """Return the students whose grade rests on the present submission, assignment and grader."""
        return {
            student
            for (student,) in self._sql.execute(
                "SELECT s.student FROM submission s JOIN grade g USING (student) JOIN grading p ON p.id = g.grading"
                " WHERE s.state = 'graded' AND p.digest = s.digest AND p.assignment = ? AND p.grader = ?",
                (assignment, grader),
            )
        }

    def evidence(self, number: int) -> str:
        """Return the evidence of a grading, as JSON."""
        return _unpacked(self._one("SELECT evidence FROM grading WHERE id = ?", number))

    def sources(self, number: int) -> dict[str, str]:
        """Return the Python files of a grading, by path."""
        sources: dict[str, str] = json.loads(
            _unpacked(self._one("SELECT sources FROM grading WHERE id = ?", number))
        )
        return sources

    def decisions(self) -> dict[str, dict[str, tuple[float, str, str]]]:
        """Return points, comment and by whom, by student and criterion."""
        found: dict[str, dict[str, tuple[float, str, str]]] = {}
        for student, criterion, *decision in self._sql.execute(
            "SELECT student, criterion, points, comment, decided_by FROM decision ORDER BY student, criterion"
        ):
            found.setdefault(student, {})[criterion] = (decision[0], decision[1], decision[2])
        return found

    def _one(self, query: str, number: int) -> bytes:
        (value,) = self._sql.execute(query, (number,)).fetchone()
        return bytes(value)


def _row(values: tuple[Any, ...]) -> Row:
    key, name, student_id, email, label, paths, attempt, is_late, notes, digest, state, reason = values[:12]
    grading, total, most, data, rubric, problem, seconds = values[12:]
    handed = HandedIn(
        key,
        name,
        student_id,
        email,
        tuple(Path(os.fsdecode(path.encode("latin-1"))) for path in json.loads(paths)),
        attempt,
        bool(is_late),
        label=label,
        reason=reason if state == "unreadable" else "",
        notes=tuple(json.loads(notes)),
    )
    worth = None if data is None else Worth(total, most, _unpacked(data), rubric)
    return Row(handed, digest, state, reason, worth, grading or 0, problem or "", seconds or 0.0)


def _packed(text: str) -> bytes:
    return zlib.compress(text.encode(errors="surrogatepass"))


def _unpacked(data: bytes) -> str:
    return zlib.decompress(data).decode(errors="surrogatepass")


def _storable(value: Any) -> Any:
    """Return a value that SQLite takes: a name of a file may be no text."""
    return value.encode(errors="backslashreplace").decode() if isinstance(value, str) else value


def _now() -> str:
    return datetime.now(timezone.utc).isoformat(timespec="seconds")
