"""Which exercises are done: kept in the student's folder, shown at the end of each lesson."""

from __future__ import annotations

import ast
import contextlib
import datetime
import fcntl
import functools
import html
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ros2lab import course

FILE, LOCK = ".progress.json", ".progress.lock"
CHOICES = ".choices.json"  # what was chosen in quizzes and predictions

_CHECKS = Path(__file__).parent / "checks"


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

        predictions = [
            entry["is_right"]
            for key, entry in choices().items()
            if isinstance(entry, dict)
            and isinstance(entry.get("is_right"), bool)  # None where nothing is right or wrong
            and (not lesson or key.startswith(f"{lesson}."))
        ]
        self.right_predictions, self.predictions = sum(predictions), len(predictions)

    def rows(self) -> list[tuple[str, str, str]]:
        """Return a mark, a name and a text for each exercise, or for each lesson."""
        if self.lesson:
            return [
                (_mark(done), name, "done" if done else "to do") for name, done in self.marks[self.lesson]
            ]
        return [
            (_mark(_is_whole(marks)), title(name), f"{sum(done for _, done in marks)} of {len(marks)}")
            for name, marks in self.marks.items()
        ]

    @property
    def next_lesson(self) -> str | None:
        """The first lesson that is not done yet, None if all are."""
        return next((name for name, marks in self.marks.items() if not _is_whole(marks)), None)

    def __repr__(self) -> str:
        width = max((len(name) for _, name, _ in self.rows()), default=0)
        lines = [f"{mark} {name.ljust(width)}  {text}" for mark, name, text in self.rows()]
        return "\n".join([*lines, *self._on_predictions()])

    def _on_predictions(self) -> list[str]:
        """Return a sentence on the predictions that were made, if there are any."""
        made, right = self.predictions, self.right_predictions
        if not made:
            return []
        return [f"{right} of {made} predictions {'was' if right == 1 else 'were'} right."]

    def _repr_html_(self) -> str:
        own = [tuple(html.escape(cell) for cell in row) for row in self.rows()]
        rows = own if self.lesson else self._linked_rows()
        cells = "".join(
            "<tr>" + "".join(f'<td style="text-align: left">{cell}</td>' for cell in row) + "</tr>"
            for row in rows
        )
        lines = [*self._on_predictions()]
        if not self.lesson and self.next_lesson:
            lines.append(f"Next: {_link(self.next_lesson)}")
        return f"<table>{cells}</table>" + "".join(f"<p>{line}</p>" for line in lines)

    def _linked_rows(self) -> list[tuple[str, ...]]:
        """Return the cells of each lesson's row: a mark, a link, a bar, and how many exercises are done."""
        return [
            (
                mark,
                _link(name),
                f'<progress max="{len(marks)}" value="{sum(done for _, done in marks)}" aria-label="{text} done"></progress>',
                text,
            )
            for (mark, _, text), (name, marks) in zip(self.rows(), self.marks.items(), strict=True)
        ]


def _is_whole(marks: Sequence[tuple[str, bool]]) -> bool:
    """Return whether all exercises of a lesson are done."""
    return all(done for _, done in marks)


def lessons() -> list[str]:
    """Return the names of the lessons' checks, in the order of the notebooks."""
    names = [path.stem.partition("_")[2] for path in course.notebooks()]
    return [name for name in names if (_CHECKS / f"{name}.py").is_file()]


def notebook_name(lesson: str) -> str:
    """Return the name of a lesson's notebook."""
    return f"{_stem(lesson)}.ipynb"


def title(lesson: str) -> str:
    """Return how a lesson is called: its number and its name."""
    return _stem(lesson).replace("_", " ")


def _stem(lesson: str) -> str:
    return next((path.stem for path in course.notebooks() if path.stem.partition("_")[2] == lesson), lesson)


def _link(lesson: str) -> str:
    """Return a link that opens the lesson from the one beside it."""
    return f'<a href="{notebook_name(lesson)}">{title(lesson)}</a>'


@functools.cache
def exercises(lesson: str) -> tuple[str, ...]:
    """Return the names of a lesson's exercises, in their order.

    They are read in the source: to import the checks of all lessons takes seconds, and ROS.
    """
    source = (_CHECKS / f"{lesson}.py").read_text(encoding="utf-8")
    names = (_exercise_in(statement) for statement in ast.parse(source).body)
    return tuple(name for name in names if name)


def _exercise_in(statement: ast.stmt) -> str | None:
    """Return the name of the exercise that a statement defines, if it does."""
    match statement:
        case ast.FunctionDef(name=name, decorator_list=[ast.Name(id="exercise")]):
            return name
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call(func=ast.Name(id="quiz_of"))):
            return name
    return None


def keep(key: str) -> None:
    """Keep that an exercise is done; a folder that cannot be written to does not spoil the check."""
    if key not in read():
        now = datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")
        _keep(FILE, key, now)


def read() -> dict[str, str]:
    """Return when each exercise was done, by `lesson.exercise`; nothing where that cannot be read."""
    return {key: str(when) for key, when in _read(FILE).items()}


def keep_choices(key: str, tried: Sequence[str]) -> None:
    """Keep what was chosen in a quiz.

    Args:
        key: `lesson.quiz`.
        tried: of each question the letters, in the order in which they were chosen.
    """
    _keep(CHOICES, key, list(tried))


def keep_prediction(key: str, chosen: str, *, is_right: bool | None) -> None:
    """Keep a prediction: `lesson.name`, the letter that was chosen, and whether it is what happens, if that is known."""
    _keep(CHOICES, key, {"chosen": chosen, "is_right": is_right})


def choices() -> dict[str, Any]:
    """Return what was chosen in quizzes and predictions, as it was kept; nothing where that cannot be read."""
    return _read(CHOICES)


def _keep(name: str, key: str, value: Any) -> None:
    with contextlib.suppress(OSError):
        file = course.work_folder() / name
        course.open_work_folder(file.parent)
        with _locked():
            kept = _read(name)
            if not kept and file.is_file():  # it cannot be read, and may be of use to somebody
                with contextlib.suppress(OSError):
                    course.keep_earlier(file)
            kept[key] = value
            course.write_whole(file, (json.dumps(kept, indent=1) + "\n").encode())


def _read(name: str) -> dict[str, Any]:
    kept = course.read_json(course.work_folder() / name)
    return {str(key): value for key, value in kept.items()} if isinstance(kept, dict) else {}


@contextlib.contextmanager
def _locked() -> Iterator[None]:
    """Keep other kernels from writing meanwhile; the file itself is replaced, so that it cannot hold the lock."""
    with (course.work_folder() / LOCK).open("a") as lock:
        with contextlib.suppress(OSError):  # a file system without locks
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _mark(is_done: bool) -> str:
    return "✔" if is_done else "○"
