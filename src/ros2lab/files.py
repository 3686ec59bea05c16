"""Small changes to a student's files, shown as they are made.

A lesson uses these where an editor would be used outside a notebook. `~` is the student's folder, as in the
lab's terminals. What a change takes away is shown with `-`, what it adds with `+`.
"""

from __future__ import annotations

import difflib
import sys
from pathlib import Path

from ros2lab import course

__all__ = ["FileError", "insert_after", "remove", "remove_lines", "replace", "show", "write"]

CONTEXT = 1  # lines shown around a change
NEAR = 0.5  # as difflib measures likeness, from 0 to 1


class FileError(Exception):
    """A file cannot be shown or changed as asked; the text says what, where, and what to do."""

    def _render_traceback_(self) -> list[str]:
        # IPython shows this instead of a traceback through the lab's own code.
        return [str(self)]


def show(path: str, around: str | None = None, lines: int = 3) -> None:
    """Print a file, or the lines around the first one that holds a text.

    Args:
        path: the file.
        around: a text; None prints the whole file.
        lines: how many lines are printed before and after the one that holds the text.

    Raises:
        FileError: if there is no such file, or no line holds the text.
    """
    text = _read(path).splitlines()
    first, last = 0, len(text)
    if around is not None:
        found = _line_with(text, around, path)
        first, last = max(0, found - lines), found + lines + 1
    sys.stdout.write("\n".join(text[first:last]) + "\n")


def write(path: str, text: str) -> None:
    """Write a new file, with its folders; an earlier file of that name is kept in `~/earlier`.

    Raises:
        FileError: if there is a folder of that name.
        OSError: if it cannot be written.
    """
    file = course.student_path(path)
    if file.is_dir():
        raise FileError(f"{path} is a folder: give the name of a file in it.")
    if file.is_file() and file.read_text(encoding="utf-8", errors="replace") != text:
        course.keep_earlier(file)
    course.write_whole(file, text.encode())
    count = len(text.splitlines())
    sys.stdout.write(f"{course.shown_path(file)}: {count} line{'s' * (count != 1)}\n")


def replace(path: str, old: str, new: str) -> None:
    """Replace a text that stands in a file exactly once.

    Raises:
        FileError: if there is no such file, or the text stands in it not once.
    """
    text = _read(path)
    count = text.count(old)
    if count != 1:
        raise FileError(
            f"{path} holds {old!r} {count} times"
            + (
                ": give more of the line, so that it is the only one."
                if count
                else f", but {new!r} stands there: was this change made before?"
                if new and new in text
                else _compare(path, text.splitlines(), old)
            )
        )
    _change(path, text, text.replace(old, new))


def insert_after(path: str, line: str, new: str) -> None:
    """Insert lines below the first line that holds the text `line`.

    Raises:
        FileError: if there is no such file, no line holds the text, or the new lines stand in the file already: a
            cell that is run twice is to do no harm.
    """
    text = _read(path)
    lines = text.splitlines(keepends=True)
    place = _line_with(lines, line, path) + 1
    new = new.rstrip("\n") + "\n"
    if new.strip() and "\n" + new.lstrip("\n") in "\n" + text:
        raise FileError(
            f"These lines stand in {path} already, so nothing was inserted: was this change made before?"
        )
    _change(path, text, "".join([*lines[:place], new, *lines[place:]]))


def remove_lines(path: str, holding: str, *, to: str | None = None) -> None:
    """Remove every line that holds a text.

    Args:
        path: the file.
        holding: the text.
        to: where the result is written instead, as `write` does; None changes the file itself.

    Raises:
        FileError: if there is no such file, or no line holds the text.
    """
    text = _read(path)
    lines = text.splitlines(keepends=True)
    _line_with(lines, holding, path)
    left = "".join(line for line in lines if holding not in line)
    if to is None:
        _change(path, text, left)
    else:
        write(to, left)


def remove(path: str) -> None:
    """Move a file or folder out of the way, to `~/earlier`.

    Raises:
        FileError: if it is not there.
        OSError: if it cannot be moved.
    """
    file = course.student_path(path)
    if not file.exists():
        raise FileError(f"There is no {path}: look at the name.")
    course.keep_earlier(file, is_moved=True)
    sys.stdout.write(f"{course.shown_path(file)} is now in {course.shown_path(course.earlier_folder())}\n")


def _read(path: str) -> str:
    file = course.student_path(path)
    if not file.is_file():
        raise FileError(f"There is no file {path}: look at the name, or make it first.")
    return file.read_text(encoding="utf-8", errors="replace")


def _line_with(lines: list[str], text: str, path: str) -> int:
    for number, line in enumerate(lines):
        if text in line:
            return number
    raise FileError(f"No line of {path} holds {text!r}{_compare(path, lines, text)}")


def _compare(path: str, lines: list[str], text: str) -> str:
    """Return the end of a sentence that says with what a text should be compared that the file does not hold."""
    first = text.strip().partition("\n")[0]
    near = difflib.get_close_matches(first, [line.strip() for line in lines], 1, NEAR)
    if near:
        return f": {near[0]!r} comes nearest."
    return f": `files.show({path!r})` prints what stands there now."


def _change(path: str, before: str, after: str) -> None:
    file: Path = course.student_path(path)
    course.write_whole(file.resolve(), after.encode())
    shown = [*difflib.unified_diff(before.splitlines(), after.splitlines(), n=CONTEXT, lineterm="")][2:]
    sys.stdout.write("\n".join(line for line in shown if not line.startswith("@@")) + "\n")
