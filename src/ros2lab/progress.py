"""Which exercises are done: kept in the student's folder, shown at the end of each lesson."""

from __future__ import annotations

import contextlib
import datetime
import fcntl
import html
import importlib
import json
from collections.abc import Iterator
from pathlib import Path

from ros2lab import course

FILE, LOCK = ".progress.json", ".progress.lock"

_exercises: dict[str, list[str]] = {}  # of each lesson, in the order in which they are defined


class Progress:
    """The exercises that are done.

    Args:
        lesson: the name of a lesson's checks, such as `workspaces`; all lessons without it.
    """

    def __init__(self, lesson: str | None = None) -> None:
        done = read()
        self.lesson = lesson
        # Of each lesson its exercises, and whether they are done.
        self.marks = {
            name: [(exercise, f"{name}.{exercise}" in done) for exercise in exercises(name)]
            for name in ([lesson] if lesson else lessons())
        }

    def rows(self) -> list[tuple[str, str, str]]:
        """Return a mark, a name and a text for each exercise, or for each lesson."""
        if self.lesson:
            return [
                (_mark(done), name, "done" if done else "to do") for name, done in self.marks[self.lesson]
            ]
        return [
            (_mark(all(done for _, done in marks)), name, f"{sum(done for _, done in marks)} of {len(marks)}")
            for name, marks in self.marks.items()
        ]

    def __repr__(self) -> str:
        width = max((len(name) for _, name, _ in self.rows()), default=0)
        return "\n".join(f"{mark} {name.ljust(width)}  {text}" for mark, name, text in self.rows())

    def _repr_html_(self) -> str:
        cells = "".join(
            "<tr>"
            + "".join(f'<td style="text-align: left">{html.escape(cell)}</td>' for cell in row)
            + "</tr>"
            for row in self.rows()
        )
        return f"<table>{cells}</table>"


def lessons() -> list[str]:
    """Return the names of the lessons' checks, in the order of the notebooks."""
    here = Path(__file__).parent / "checks"
    names = [path.stem.partition("_")[2] for path in course.notebooks()]
    return [name for name in names if (here / f"{name}.py").is_file()]


def exercises(lesson: str) -> list[str]:
    """Return the names of a lesson's exercises, in their order."""
    importlib.import_module(f"ros2lab.checks.{lesson}")
    return _exercises.get(lesson, [])


def register(key: str) -> None:
    """Make an exercise known: `lesson.exercise`."""
    lesson, _, name = key.partition(".")
    known = _exercises.setdefault(lesson, [])
    if name not in known:
        known.append(name)


def keep(key: str) -> None:
    """Keep that an exercise is done; a folder that cannot be written to does not spoil the check."""
    if key in read():
        return
    with contextlib.suppress(OSError):
        course.open_work_folder(_file().parent)
        with _locked():
            done = read()
            if not done and _file().is_file():  # it cannot be read, and may be of use to somebody
                with contextlib.suppress(OSError):
                    course.keep_earlier(_file())
            done[key] = datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")
            course.write_whole(_file(), (json.dumps(done, indent=1) + "\n").encode())


def read() -> dict[str, str]:
    """Return when each exercise was done, by `lesson.exercise`; nothing where that cannot be read."""
    try:
        done = json.loads(_file().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return {str(key): str(when) for key, when in done.items()} if isinstance(done, dict) else {}


@contextlib.contextmanager
def _locked() -> Iterator[None]:
    """Keep other kernels from writing meanwhile; the file itself is replaced, so that it cannot hold the lock."""
    with _file().with_name(LOCK).open("a") as lock:
        with contextlib.suppress(OSError):  # a file system without locks
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _file() -> Path:
    return course.work_folder() / FILE


def _mark(is_done: bool) -> str:
    return "✔" if is_done else "○"
