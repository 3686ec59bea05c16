"""The cell magic `%%editor PATH`: the cell is a file, and running it saves the file."""

from __future__ import annotations

import sys
from pathlib import Path

from IPython.core.error import UsageError

from ros2lab import course

_written: dict[Path, str] = {}  # what was saved here last, so that only what somebody else wrote is kept


def save_cell(line: str, cell: str) -> None:
    """Save the cell as a file: `%%editor PATH`; what another program has written there is kept in `~/earlier`.

    `~` is the home of the lab's terminals, and what is relative is below it.
    """
    given = line.strip().strip("\"'")
    if not given:
        raise UsageError("Which file? Write its name: %%editor ~/ros2_ws/README.md")
    path = course.student_path(given)
    text = cell if cell.endswith("\n") else f"{cell}\n"
    shown = course.shown_path(path)
    if path.is_dir() or given.endswith("/"):
        raise UsageError(f"{shown} names a folder: write a file's name after it, such as {shown}/README.md")
    if not path.parent.is_dir():
        raise FileNotFoundError(
            f"There is no folder {course.shown_path(path.parent)}: make it first, with `mkdir -p`."
        )
    kept = ""
    if path.is_file():
        before = path.read_bytes()
        if before not in (text.encode(), _written.get(path, "").encode()) and before.strip():
            course.keep_earlier(path)
            kept = f"; what was there before is in {course.shown_path(course.earlier_folder())}"
    course.write_whole(path.resolve(), text.encode())  # a link stays one
    _written[path] = text
    lines = text.count("\n")
    sys.stdout.write(f"{shown}: {lines} line{'s' * (lines != 1)}{kept}\n")
