"""Grade a class: what is new or was changed, into the gradebook, from which it goes on after any interruption."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from ros2lab.classroom import capacity, cluster, identity
from ros2lab.classroom.display import Display
from ros2lab.classroom.gradebook import Gradebook, Row, Worth
from ros2lab.classroom.handed_in import HandedIn, called
from ros2lab.classroom.judging import Judging
from ros2lab.classroom.side_by_side import Done, Step, Task, grade
from ros2lab.grading.reports.shown import number
from ros2lab.grading.sandbox.compiled import compile_modules

EMPTY = "Nothing was handed in: it is empty."


@dataclass(frozen=True)
class Plan:
    """What there is to do.

    Attributes:
        tasks: each is graded once.
        again: students whose submission was graded before, with the number of that grading: only judged.
        done: students for whom nothing is to be done.
    """

    tasks: list[Task]
    again: dict[str, int]
    done: list[str]


def identified(
    found: Iterable[HandedIn], everybody: Iterable[HandedIn] = ()
) -> Iterator[tuple[HandedIn, str, int]]:
    """Yield each row with the digest of what was handed in, and when that was written.

    What is empty, cannot be read, or is the same as somebody else's, says so.

    Args:
        found: the rows.
        everybody: all rows of the class, if these are only some.
    """
    rows = [*_digested(found)]
    names = called({row.key: row for row in (*everybody, *(handed for handed, *_ in rows))}.values())
    same: dict[str, list[HandedIn]] = {}
    for handed, digest, _ in rows:
        if not handed.reason:
            same.setdefault(digest, []).append(handed)
    for handed, digest, written_at in rows:
        # Of all of them, for nobody knows whose it was first.
        twins = [
            names[twin.key]
            for twin in same.get(digest, ())
            if twin.paths != handed.paths and not handed.reason
        ]
        notes = [f"It is, byte for byte, what {name} has handed in." for name in twins]
        yield replace(handed, notes=(*handed.notes, *notes)), digest, written_at


def _digested(found: Iterable[HandedIn]) -> Iterator[tuple[HandedIn, str, int]]:
    for handed in found:
        if handed.reason:
            yield handed, "", 0
            continue
        missing = next((path for path in handed.paths if not path.exists()), None)
        if missing is not None or not handed.paths:
            yield replace(handed, reason=f"There is no {missing or 'file'}."), "", 0
            continue
        try:
            digest, written_at = identity.submission(handed.paths)
        except OSError as error:
            yield replace(handed, reason=f"It cannot be read ({error.strerror or error})."), "", 0
            continue
        if _is_empty(handed.paths):
            yield replace(handed, reason=EMPTY), digest, written_at
            continue
        yield handed, digest, written_at


def _is_empty(paths: Sequence[Path]) -> bool:
    """Return whether there is no byte in what was handed in."""
    files = (file for path in paths for _, file in identity.files(path))
    return not any(file.is_file() and file.stat().st_size for file in files)


def plan(book: Gradebook, judging: Judging, rows: Iterable[Row], *, only_failed: bool = False) -> Plan:
    """Return what is to be done for rows of the gradebook.

    Args:
        book: the gradebook.
        judging: by what the class is judged.
        rows: those that are meant.
        only_failed: take only those at which the grader has failed.
    """
    grader = identity.grader()
    known = book.graded_before(judging.assignment_digest, grader)
    current = book.current(judging.assignment_digest, grader)
    rows = [*rows]
    names = called(row.handed for row in rows)
    groups: dict[str, list[Row]] = {}
    again, done = dict[str, int](), list[str]()
    for row in rows:
        key = row.handed.key
        if row.state == "unreadable" or key in current or (only_failed and row.state != "failed"):
            done.append(key)
        elif row.digest in known:
            again[key] = known[row.digest]
        else:
            groups.setdefault(row.digest, []).append(row)
    tasks = [
        Task(digest, same[0].handed.paths, names[same[0].handed.key], tuple(row.handed.key for row in same))
        for digest, same in groups.items()
    ]
    return Plan(tasks, again, done)


def carry_out(
    book: Gradebook, judging: Judging, todo: Plan, display: Display, *, jobs: int | None, scheduler: str = ""
) -> None:
    """Grade what is to be graded; each is in the gradebook as soon as it has ended.

    Args:
        book: the gradebook.
        judging: by what the class is judged.
        todo: what there is to do.
        display: shown what happens.
        jobs: how many at once on this machine; None for what it bears.
        scheduler: the address of a cluster on which it is done instead; empty for this machine.

    Raises:
        CannotGrade: if this machine, or the cluster, cannot grade.
        ClassError: if there is no such cluster.
        sqlite3.Error: if the gradebook cannot be written.
    """
    names = {row.handed.key: row.handed.name for row in book.rows()}
    worths: dict[int, dict[str, Worth | str]] = {}
    for student, before in todo.again.items():
        worth = judging.worth(book.evidence(before), student, names[student])
        worths.setdefault(before, {})[student] = worth
    book.judge(worths)
    if todo.tasks and not scheduler:
        compile_modules()
    if scheduler:
        running = cluster.grade(todo.tasks, scheduler, judging.assignment, display.warn)
    elif jobs is None:
        running = grade(todo.tasks, capacity.automatic(), judging.assignment, capacity.Gate())
    else:
        running = grade(todo.tasks, jobs, judging.assignment)
    with closing(running) as events:
        for event in events:
            if isinstance(event, Step):
                display.step(event.task.digest, event.task.name, event.text)
            else:
                _end(book, judging, event, display, lambda student: names[student])


def _end(
    book: Gradebook, judging: Judging, event: Done, display: Display, name_of: Callable[[str], str]
) -> None:
    task, seen = event.task, event.result
    if isinstance(seen, str):
        book.fail(task.students, seen)
        display.end(task.digest, task.name, seen, {"state": "failed", "reason": seen}, has_failed=True)
        return
    given = {student: judging.worth(seen.evidence, student, name_of(student)) for student in task.students}
    book.record(task.digest, judging.assignment_digest, identity.grader(), seen, given)
    worth = given[task.students[0]]
    if isinstance(worth, str):
        display.end(task.digest, task.name, worth, {"state": "failed", "reason": worth}, has_failed=True)
        return
    said = f"{number(worth.total)} of {number(worth.max)}" + (f", {seen.problem}" if seen.problem else "")
    facts = {"state": "graded", "total": worth.total, "max": worth.max, "problem": seen.problem}
    display.end(task.digest, task.name, said, facts, has_failed=False)
