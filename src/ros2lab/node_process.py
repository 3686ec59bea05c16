"""An executable of a package, running as a process of its own."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import threading
from collections import deque
from collections.abc import Mapping

from ros2lab.interrupts import interrupted_says
from ros2lab.process_family import end_kept, kept

READER_TIMEOUT = 5.0  # s, for what is still in the pipe when a process has ended


class NodeProcess:
    """An executable of a package, running as a process of its own.

    Made by `LabSession.start_process`.
    """

    def __init__(self, package: str, executable: str, command: list[str], environ: Mapping[str, str]) -> None:
        self.package = package
        self.executable = executable
        self._lines: deque[str] = deque(maxlen=1000)
        self._popen = subprocess.Popen(
            kept(command),
            env={**environ, "PYTHONUNBUFFERED": "1"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            # Interrupting a cell must not interrupt the nodes.
            start_new_session=True,
        )
        self._reader = threading.Thread(target=self._read, name=f"ros2lab-output-{executable}", daemon=True)
        self._reader.start()

    @property
    def pid(self) -> int:
        """The process's number."""
        return self._popen.pid

    @property
    def returncode(self) -> int | None:
        """The exit code; None while it runs, negative if a signal ended it."""
        return self._popen.poll()

    @property
    def is_running(self) -> bool:
        """Whether the process has not ended."""
        return self.returncode is None

    @property
    def output(self) -> str:
        """What it has printed, standard error included: the newest thousand lines."""
        return "".join(self._lines.copy())

    def wait(self, timeout: float | None = None) -> int:
        """Wait for the end and return the exit code.

        Raises:
            TimeoutError: if it still runs after `timeout` seconds.
        """
        try:
            with interrupted_says(f"{self.executable} goes on."):
                code = self._popen.wait(timeout)
        except subprocess.TimeoutExpired:
            raise TimeoutError(f"{self.executable} still runs after {timeout:g} s.") from None
        self._reader.join(READER_TIMEOUT)
        return code

    def interrupt(self, timeout: float = 5.0) -> int:
        """Do what Ctrl-C does, and return the exit code.

        Args:
            timeout: how long the process is given to end, in s.

        Raises:
            TimeoutError: if it still runs then.
        """
        self._popen.send_signal(signal.SIGINT)
        return self.wait(timeout)

    def stop(self, timeout: float = 5.0) -> int:
        """End the process as Ctrl-C would, harder if it does not listen, and return the exit code.

        Args:
            timeout: how long SIGINT, and then SIGTERM, are given before the next, in s.
        """
        for number in (signal.SIGINT, signal.SIGTERM):
            if self.is_running:
                self._popen.send_signal(number)
                with contextlib.suppress(subprocess.TimeoutExpired):
                    self._popen.wait(timeout)
        end_kept(self._popen)
        return self.wait()

    def _read(self) -> None:
        assert self._popen.stdout is not None
        with self._popen.stdout as stream:
            self._lines.extend(stream)

    def __repr__(self) -> str:
        state = "running" if self.is_running else f"ended with {self.returncode}"
        return f"NodeProcess({self.package} {self.executable}, {state})"


def last_line(output: str) -> str:
    """Return the last line that a program has said by itself; nothing if it has said nothing."""
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    return next((line for line in lines[::-1] if not line.startswith(("[ros2run]", "[INFO] [launch]"))), "")
