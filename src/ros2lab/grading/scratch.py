"""A folder for one grading, which is gone after it, or else when the next one begins."""

from __future__ import annotations

import contextlib
import fcntl
import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

PREFIX = "ros2lab-grade-"
YOUNG = 10.0  # s, in which a folder that was made is locked


@contextlib.contextmanager
def scratch_folder() -> Iterator[Path]:
    """Make a folder and remove it at the end; remove before it what killed graders of this user have left."""
    _sweep(Path(tempfile.gettempdir()))
    prefix = f"{PREFIX}{os.getpid()}-"
    with tempfile.TemporaryDirectory(prefix=prefix, ignore_cleanup_errors=True) as folder:
        # Who holds the lock is alive.
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX)
            yield Path(folder)
        finally:
            os.close(handle)


def _sweep(place: Path) -> None:
    for folder in place.glob(f"{PREFIX}[0-9]*-*"):
        with contextlib.suppress(OSError):
            handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
            try:
                state = os.fstat(handle)
                if state.st_uid == os.getuid() and time.time() - state.st_mtime > YOUNG:
                    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    shutil.rmtree(folder, ignore_errors=True)
            finally:
                os.close(handle)
