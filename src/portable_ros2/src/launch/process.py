"""A process and what it writes, in an asyncio loop and without threads."""

from __future__ import annotations

import asyncio
import ctypes
import os
import pty
import signal
import subprocess
from collections.abc import Callable, Mapping

PR_SET_PDEATHSIG = 1
CHUNK = 65536  # bytes
# A process may leave children that keep its output open; this long they may still write.
LAST_WORDS = 0.2  # s

_running: set[Process] = set()


class Process:
    """A running process.

    The loop must call `reap` on SIGCHLD. The process ends when this one does, however that ends.

    Args:
        loop: the running loop.
        cmd: the program and its arguments.
        on_output: is called with 1 (standard output) or 2 (standard error) and what was written.
        cwd: the folder it runs in.
        env: its environment variables.
        shell: let a shell understand the command.
        emulate_tty: let it write to terminals instead of pipes.
        own_group: let a signal that is sent to all processes of this launch pass it by.

    Raises:
        OSError: if it cannot be started.
    """

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        cmd: list[str],
        on_output: Callable[[int, bytes], None],
        *,
        cwd: str | None = None,
        env: Mapping[str, str] | None = None,
        shell: bool = False,
        emulate_tty: bool = False,
        own_group: bool = False,
    ) -> None:
        self.exited: asyncio.Future[int] = loop.create_future()
        self._loop = loop
        self._on_output = on_output
        ends = {1: pty.openpty(), 2: pty.openpty()} if emulate_tty else {1: os.pipe(), 2: os.pipe()}
        self._open = {source: ours for source, (ours, _) in ends.items()}
        try:
            self._popen = subprocess.Popen(
                " ".join(cmd) if shell else cmd,
                stdin=subprocess.PIPE,
                stdout=ends[1][1],
                stderr=ends[2][1],
                cwd=cwd,
                env=env,
                shell=shell,
                preexec_fn=_ends_with(os.getpid(), own_group),  # noqa: PLW1509 -- there are no threads
            )
        except OSError:
            for fd in self._open.values():
                os.close(fd)
            raise
        finally:
            for _, theirs in ends.values():
                os.close(theirs)
        for source, fd in self._open.items():
            os.set_blocking(fd, False)
            loop.add_reader(fd, self._read, source)
        _running.add(self)

    @property
    def pid(self) -> int:
        """Its number."""
        return self._popen.pid

    def send_signal(self, number: int) -> None:
        """Send a signal, unless it has ended."""
        self._popen.send_signal(number)

    def poll(self) -> None:
        """Look whether it has ended."""
        if self._popen.poll() is None:
            return
        _running.discard(self)
        if self._open:
            self._loop.call_later(LAST_WORDS, self._finish)
        else:
            self._finish()

    def _read(self, source: int) -> None:
        try:
            data = os.read(self._open[source], CHUNK)
        except BlockingIOError:
            return
        except OSError:  # how a terminal ends
            data = b""
        if data:
            self._on_output(source, data)
            return
        self._close(source)
        if not self._open and self._popen.returncode is not None:
            self._finish()

    def _close(self, source: int) -> None:
        fd = self._open.pop(source)
        self._loop.remove_reader(fd)
        os.close(fd)

    def _finish(self) -> None:
        for source in list(self._open):
            self._close(source)
        if self._popen.stdin is not None:
            self._popen.stdin.close()
        if not self.exited.done():
            self.exited.set_result(self._popen.returncode)


def reap() -> None:
    """Look which processes have ended."""
    for process in list(_running):
        process.poll()


def _ends_with(parent: int, own_group: bool) -> Callable[[], None]:
    """Return what a child does first: ask the kernel to end it when its parent is gone."""
    prctl = ctypes.CDLL(None).prctl

    def ask() -> None:
        prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if own_group:
            os.setpgid(0, 0)
        if os.getppid() != parent:
            os._exit(1)

    return ask
