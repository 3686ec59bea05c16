"""A folder for a while, which is gone after it, or else when the next one begins."""

from __future__ import annotations

import contextlib
import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

PREFIX = "ros2lab-scratch-"


@contextlib.contextmanager
def scratch_folder(place: Path | None = None) -> Iterator[Path]:
    """Make a folder and remove it at the end; remove before it what killed processes of this user have left.

    Args:
        place: in which it is made, hidden; None is the folder for temporary files.

    Raises:
        OSError: if it cannot be made.
    """
    prefix = PREFIX if place is None else f".{PREFIX}"
    place = place or Path(tempfile.gettempdir())
    _sweep(place, prefix)
    folder, handle = _locked_folder(place, prefix)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(handle)


def _locked_folder(place: Path, prefix: str) -> tuple[Path, int]:
    """Make a folder; who holds its lock is alive. Another process may take it for stale until it is locked."""
    while True:
        folder = Path(tempfile.mkdtemp(prefix=prefix, dir=place))
        with contextlib.suppress(FileNotFoundError):
            handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
            try:
                with contextlib.suppress(OSError):  # where no disk has locks, nothing is swept, either
                    fcntl.flock(handle, fcntl.LOCK_EX)
                folder.stat()
            except BaseException:
                os.close(handle)
                raise
            return folder, handle


def _sweep(place: Path, prefix: str) -> None:
    for folder in place.glob(f"{prefix}*"):
        with contextlib.suppress(OSError):
            handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
            try:
                if os.fstat(handle).st_uid == os.getuid():
                    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    shutil.rmtree(folder, ignore_errors=True)
            finally:
                os.close(handle)
