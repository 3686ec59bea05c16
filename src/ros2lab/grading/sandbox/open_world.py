"""Run a submission's programs without a sandbox, where none can be made and the user insists.

They can read, change and send whatever the user who grades can. Only time, output and the resources of each
process are limited; processes that they leave behind are ended.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import subprocess
import threading
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import psutil

from ros2lab.grading.sandbox.box import Box, End, Limits
from ros2lab.grading.sandbox.keeper import LIMITS
from ros2lab.grading.sandbox.neighbours import Neighbours
from ros2lab.grading.sandbox.worlds import ENVIRON, FILES, HOME, Access, World
from ros2lab.process_family import end_kept, kept
from ros2lab.scratch import scratch_folder

NAME = "none: --unsafe-no-sandbox"
TMP = "/tmp"  # noqa: S108 -- below the scratch folder
POLL = 0.1  # s between two checks whether a silent program has ended


class OpenWorld(World):
    """A private copy of a folder, and unconfined programs in it; used like a `World`.

    Args:
        files: the folder to copy; None starts with an empty one.
        shown: ignored: everything can be seen.
        limits: the limits of a box that is given no others.
    """

    def __init__(
        self, files: Path | None = None, *, shown: Iterable[Path] = (), limits: Limits | None = None
    ) -> None:
        self._given = [*shown]
        self.limits = limits or Limits()
        self.folders = []  # no folders are made on the machine itself
        self._open = contextlib.ExitStack()
        self._scratch = str(self._open.enter_context(scratch_folder()))
        self.folder = Path(self._scratch, FILES.strip("/"))
        for name in (FILES, HOME):
            Path(self._moved(name)).mkdir(parents=True)
        self._running: set[_OpenBox] = set()
        if files is not None:
            self.fill(files)

    def start(
        self,
        command: Sequence[str | Path],
        *,
        files: Access = "read",
        environ: Mapping[str, str] | None = None,
        cwd: str = TMP,
        stdin: int | None = None,
        shown: Iterable[Path] = (),
        limits: Limits | None = None,
        among: str = "",
        neighbours: Neighbours | None = None,
    ) -> Box:
        """Start a program.

        Args:
            command: the program and its arguments; /submission in them is the copy.
            files: ignored.
            environ: the environment; `ENVIRON` has the defaults.
            cwd: the working folder.
            stdin: a file descriptor that the program reads from; None gives it nothing to read.
            shown: ignored.
            limits: the box's limits; None takes the World's.
            among: ignored: all share /tmp.
            neighbours: ignored: all see each other's processes.
        """
        del files, shown, among, neighbours
        limits = limits or self.limits
        words = {**ENVIRON, **(environ or {})}
        box = _OpenBox(
            [*limits.words(), *(self._moved(str(word)) for word in command)],
            environ={name: self._moved(value) for name, value in words.items()},
            cwd=self._moved(cwd),
            stdin=stdin,
            limits=limits,
            scratch=self._scratch,
        )
        self._running.add(box)
        return box

    def close(self) -> None:
        """End everything that was started; closing twice does nothing."""
        for box in self._running:
            box.kill()
            box.join()
        self._running.clear()
        self._open.close()

    def _moved(self, text: str) -> str:
        """Return a text with the scratch folder before the paths that a sandbox would have."""
        if text == TMP:
            return f"{self._scratch}{TMP}"
        for path in (FILES, HOME):
            text = text.replace(path, f"{self._scratch}{path}")
        return text


class _OpenBox(Box):
    def __init__(
        self,
        command: Sequence[str],
        *,
        environ: Mapping[str, str],
        cwd: str,
        stdin: int | None,
        limits: Limits,
        scratch: str,
    ) -> None:
        super().__init__(self._signal, limits.output_bytes)
        self._limits = limits
        self._scratch = scratch
        self._reading, writing = os.pipe()
        try:
            self._popen = subprocess.Popen(
                kept(command),
                cwd=cwd,
                env=dict(environ),
                stdin=subprocess.DEVNULL if stdin is None else stdin,
                stdout=writing,
                stderr=writing,
                start_new_session=True,
            )
        except BaseException:
            os.close(self._reading)
            raise
        finally:
            os.close(writing)
        self._thread = threading.Thread(target=self._watch, name="ros2lab-open-box", daemon=True)
        self._thread.start()

    @property
    def output(self) -> str:
        """What the program has written so far, with the paths that a sandbox would show."""
        return super().output.replace(self._scratch, "")

    def join(self) -> None:
        """Wait until all output is read."""
        self._thread.join()

    def _signal(self, do: str) -> None:
        if do == "interrupt":
            self._popen.send_signal(signal.SIGINT)
        elif do == "kill":
            end_kept(self._popen)
        else:
            self._signal_all(signal.SIGSTOP if do == "hold" else signal.SIGCONT)
        if do == "hold":
            self._set_standing()

    def _signal_all(self, number: int) -> None:
        with contextlib.suppress(psutil.NoSuchProcess):
            for process in psutil.Process(self._popen.pid).children(recursive=True):
                with contextlib.suppress(psutil.NoSuchProcess, psutil.AccessDenied):
                    process.send_signal(number)

    def _watch(self) -> None:
        """Read the program's output until it has ended or its time is up."""
        deadline, cut = time.monotonic() + self._limits.wall_s, None
        is_open = True
        while self._popen.poll() is None:
            if is_open and select.select([self._reading], [], [], POLL)[0]:
                is_open = self._add(os.read(self._reading, 65536))
            elif not is_open:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    self._popen.wait(POLL)
            if cut is None and time.monotonic() > deadline:
                cut = LIMITS["time"].format(self._limits.wall_s)
                self._signal("kill")
        while is_open and select.select([self._reading], [], [], POLL)[0]:
            is_open = self._add(os.read(self._reading, 65536))
        if is_open:
            self._add(b"")
        os.close(self._reading)
        code = self._popen.returncode
        if code == -signal.SIGHUP:  # killed before it had really started
            code = -signal.SIGKILL
        self._set_end(
            End(128 - code if code < 0 else code, cut, time.monotonic() - self._start, was_made=True)
        )
