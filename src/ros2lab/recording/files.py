"""The files of recordings in the student's folder."""

from __future__ import annotations

import difflib
import sys
from pathlib import Path
from typing import IO

from portable_ros2.bags.mcap_file import RecordingFile
from ros2lab import course


def new_file(path: Path) -> IO[bytes]:
    """Open a new file; an existing one of its name is moved to `~/earlier` first."""
    if path.is_dir():
        raise ValueError(f"{course.shown_path(path)} is a folder; name a file, such as drive.mcap.")
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists():
        try:
            kept = course.keep_earlier(path, is_moved=True)
        except OSError:  # on another disk
            kept = course.keep_earlier(path)
            path.unlink()
        sys.stdout.write(f"The earlier {path.name} is kept as {course.shown_path(kept)}.\n")
    return path.open("xb")


def open_recording(path: Path) -> RecordingFile:
    """Open a recording.

    Raises:
        FileNotFoundError: if there is no such file; the text names those that are there.
        ValueError: if it is not MCAP, or holds nothing of ROS 2.
    """
    shown = course.shown_path(path)
    try:
        return RecordingFile(path, shown)
    except FileNotFoundError:
        there = sorted(found.name for found in path.parent.glob("*.mcap"))
        named = f"there are: {', '.join(there)}" if there else "there is no recording"
        raise FileNotFoundError(
            f"There is no file {shown}; in {course.shown_path(path.parent)} {named}."
        ) from None


def no_topic(file: RecordingFile, topic: str) -> str:
    """Return a sentence that says that a recording does not hold a topic, and what it holds."""
    close = difflib.get_close_matches(topic, file.topics, n=1, cutoff=0.6)
    hint = (
        f"did you mean {close[0]}?" if close else f"it holds: {', '.join(sorted(file.topics)) or 'nothing'}."
    )
    return f"{file.shown} holds no topic {topic}; {hint}"
