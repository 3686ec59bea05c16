"""A command in the background of a test, and how a test waits for something."""

from __future__ import annotations

import re
import signal
import subprocess
import sysconfig
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from deadlines import DEADLINE

COMMAND = str(Path(sysconfig.get_path("scripts"), "ros2"))


def until(condition: Callable[[], Any], what: str) -> Any:
    """Return the first true answer; fail after the deadline."""
    deadline = time.monotonic() + DEADLINE
    while not (answer := condition()):
        assert time.monotonic() < deadline, f"{what}: not within {DEADLINE} s"
        time.sleep(0.01)
    return answer


class Running:
    """A command that runs in the background; its output goes to files."""

    def __init__(self, folder: Path, *words: str) -> None:
        self._out, self._err = folder / "out", folder / "err"
        with self._out.open("w") as out, self._err.open("w") as err:
            self.process = subprocess.Popen(
                [COMMAND, *words], stdin=subprocess.DEVNULL, stdout=out, stderr=err, start_new_session=True
            )

    @property
    def output(self) -> str:
        return self._out.read_text()

    @property
    def errors(self) -> str:
        return self._err.read_text()

    def wait_for(self, pattern: str) -> re.Match[str]:
        def found() -> re.Match[str] | None:
            match = re.search(pattern, self.output)
            ended = self.process.poll() is not None and match is None
            assert not ended, f"ended before {pattern!r}: {self.output}{self.errors}"
            return match

        match: re.Match[str] = until(found, pattern)
        return match

    def end(self, number: signal.Signals = signal.SIGINT) -> int:
        """Send a signal and return the exit code."""
        self.process.send_signal(number)
        return self.process.wait(DEADLINE)
