"""A program that runs in the sandbox: what it may use, what it writes, and how it ends."""

from __future__ import annotations

import contextlib
import os
import re
import resource
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ros2lab.grading.sandbox.keeper import LIMITS
from ros2lab.grading.senses import without_codes

SIGNALS = 256  # that may be pending in a box
# The least that this process must be allowed so that programs are graded fairly, by the letter of `ulimit`.
ALLOWED = {
    "f": (resource.RLIMIT_FSIZE, 100_000_000),
    "t": (resource.RLIMIT_CPU, 3600),
    "v": (resource.RLIMIT_AS, 8_000_000_000),
}


class SandboxMissing(Exception):  # noqa: N818 -- not the program's fault
    """This machine cannot run a submission safely; the message says what to install or to allow."""


@dataclass(frozen=True)
class Limits:
    """What a box may use. All processes of the box count together unless it says otherwise.

    Attributes:
        wall_s: from the start to the end, in s.
        cpu_s: CPU time, in s.
        memory_bytes: resident memory, page tables, maps, and what open sockets can buffer; memory that two
            processes share counts twice. Also each process's own data.
        together_bytes: resident memory, page tables and open files of all boxes of the World; the largest box
            is ended.
        processes: processes and threads at the same time.
        open_files: of each process.
        file_bytes: the largest file.
        disk_bytes: each of /tmp and /dev/shm; of the World's limits: /submission. An empty file counts 4096.
        output_bytes: standard output and standard error together.
        spare_bytes: memory that the machine must have left; if it has less, that is not the program's fault.
    """

    wall_s: float = 60.0
    cpu_s: float = 60.0
    memory_bytes: int = 2_000_000_000
    together_bytes: int = 4_000_000_000
    processes: int = 512
    open_files: int = 1024
    file_bytes: int = 100_000_000
    disk_bytes: int = 256_000_000
    output_bytes: int = 1_000_000
    spare_bytes: int = 200_000_000

    def words(self) -> list[str]:
        """Return the words before a command that set its limits in a box, where only its processes count."""
        wanted = {
            "nproc": (resource.RLIMIT_NPROC, self.processes),
            "data": (resource.RLIMIT_DATA, self.memory_bytes),
            "nofile": (resource.RLIMIT_NOFILE, self.open_files),
            "fsize": (resource.RLIMIT_FSIZE, self.file_bytes),
            "core": (resource.RLIMIT_CORE, 0),
            # The keeper counts these two.
            "as": (resource.RLIMIT_AS, resource.RLIM_INFINITY),
            "cpu": (resource.RLIMIT_CPU, resource.RLIM_INFINITY),
            "rtprio": (resource.RLIMIT_RTPRIO, 0),
            "sigpending": (
                resource.RLIMIT_SIGPENDING,
                SIGNALS,
            ),  # the default is all that the grading user may have
        }
        words = ["/usr/bin/prlimit"]
        for name, (number, most) in wanted.items():
            _, allowed = resource.getrlimit(number)
            least = min(
                (limit for limit in (most, allowed) if limit != resource.RLIM_INFINITY), default="unlimited"
            )
            words.append(f"--{name}={least}")
        return words


@dataclass(frozen=True)
class End:
    """How a box ended."""

    code: int
    cut: str | None
    seconds: float
    was_made: bool
    fault: str = ""


class Box:
    """A program that runs in a World. Made by `World.start`."""

    def __init__(self, ask: Callable[[str], None], output_bytes: int) -> None:
        self._ask = ask
        self._output_bytes = output_bytes
        self._reading = -1  # the pipe that carries its output
        self._bell = -1  # closing it shows the box all of its neighbours
        self._start = time.monotonic()
        self._changed = threading.Condition()
        self._written = bytearray()
        self._is_writing = True
        self._excess: str | None = None
        self._end: End | None = None
        self._stands = False

    @property
    def output(self) -> str:
        """Its output on both streams so far, in order, as plain text without terminal codes."""
        with self._changed:
            text = self._written.decode(errors="replace")
        return without_codes(text.replace("\r\n", "\n").replace("\r", "\n"))

    @property
    def code(self) -> int | None:
        """The exit code, 128 + n if signal n ended it; None while it runs."""
        end = self._final()
        return end.code if end else None

    @property
    def cut(self) -> str | None:
        """A sentence that says which limit ended it; None if none did."""
        end = self._final()
        return self._excess or (end.cut if end else None)

    @property
    def seconds(self) -> float:
        """How long it ran, or has run so far, in s."""
        end = self._final()
        return end.seconds if end else time.monotonic() - self._start

    def wait(self, timeout: float | None = None) -> int:
        """Wait for the end and return the exit code.

        Raises:
            TimeoutError: if it still runs after `timeout` seconds.
            SandboxMissing: if the box could not be made.
        """
        with self._changed:
            end = self._changed.wait_for(self._final, timeout)
        if end is None:
            raise TimeoutError(f"The program still runs after {timeout:g} s; give it longer or kill it.")
        if not end.was_made:
            raise SandboxMissing(why(self.output))
        return end.code

    def wait_for(self, text: str, timeout: float) -> bool:
        """Wait for `text` in the output; return False if it ends, or `timeout` seconds pass, without it."""
        with self._changed:
            self._changed.wait_for(lambda: text in self.output or self._final(), timeout)
        return text in self.output

    def interrupt(self) -> None:
        """Send SIGINT to the program and its children, as Ctrl-C at a terminal does."""
        self._ask("interrupt")

    def kill(self) -> None:
        """End everything in the box at once."""
        self._ask("kill")

    def hold(self, timeout: float) -> bool:
        """Pause everything in the box until `release`; return whether all of it has paused, or ended."""
        with self._changed:
            self._stands = False
            self._ask("hold")
            return self._changed.wait_for(lambda: self._stands or bool(self._end), timeout)

    def show_neighbours(self) -> None:
        """Show the box the processes of its neighbours that were started after it, too."""
        with self._changed:
            bell, self._bell = self._bell, -1
        if bell >= 0:
            os.close(bell)

    def release(self) -> None:
        """Resume everything in the box."""
        self._ask("release")

    def __repr__(self) -> str:
        return f"Box({'running' if self.code is None else f'ended with {self.code}'})"

    def _final(self) -> End | None:
        """Return how it ended; None until all its output is here; SandboxMissing if the machine ended it."""
        if self._end and self._end.fault:
            raise SandboxMissing(
                f"{self._end.fault}: end other programs, or grade fewer submissions at once."
            )
        return None if self._is_writing else self._end

    def _add(self, part: bytes) -> bool:
        """Add a part of its output, empty at the end; return whether more is wanted."""
        room = self._output_bytes - len(self._written)
        with self._changed:
            self._written += part[:room]
            if len(part) > room:
                self._excess = LIMITS["output"].format(self._output_bytes / 1_000_000)
            self._is_writing = bool(part) and not self._excess
            self._changed.notify_all()
        if self._excess:
            self._ask("kill")
        return self._is_writing

    def _set_standing(self) -> None:
        with self._changed:
            self._stands = True
            self._changed.notify_all()

    def _set_end(self, end: End) -> None:
        with self._changed:
            self._end = self._end or end
            self._changed.notify_all()
        self.show_neighbours()


def refuse_narrow_limits() -> None:
    """Refuse to run programs if this process may not give them what they need.

    Raises:
        SandboxMissing: if a limit is too low; the message names it.
    """
    for letter, (number, least) in ALLOWED.items():
        _, allowed = resource.getrlimit(number)
        if allowed != resource.RLIM_INFINITY and allowed < least:
            raise SandboxMissing(
                f"A program may use too little here for a fair grade: start the grader where `ulimit -H{letter}` is unlimited."
            )


def allow_open_files() -> None:
    """Raise the limit of open files, for this process and the keeper that it starts, as far as is allowed.

    Linux counts the file descriptors that all processes of a user are passing to each other, and refuses to
    pass another one if there are more than the sender may have open. What runs in a box may have fewer.
    """
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))


def why(said: str, kernel: Path = Path("/proc/sys")) -> str:
    """Say in one sentence why bubblewrap could not make a box, and what to do.

    Args:
        said: what bubblewrap printed.
        kernel: where the kernel's settings are.
    """
    reason = (said.strip().splitlines() or ["bubblewrap said nothing"])[-1]
    if not re.search("namespace|not permitted|uid map", said):
        return f"bubblewrap could not make a sandbox: {reason}."
    # The setting, the value that refuses, what that means, and the value that allows.
    for name, refusing, meaning, fix in (
        (
            "kernel.apparmor_restrict_unprivileged_userns",
            "1",
            "AppArmor keeps bubblewrap from making a sandbox",
            "0",
        ),
        ("kernel.unprivileged_userns_clone", "0", "This kernel lets only root make a sandbox", "1"),
        ("user.max_user_namespaces", "0", "This kernel allows no user namespaces", "10000"),
    ):
        with contextlib.suppress(OSError):
            if (kernel / name.replace(".", "/")).read_text(encoding="ascii").strip() == refusing:
                return f"{meaning}: run `sudo sysctl {name}={fix}`."
    return (
        f"This machine, probably a container, allows no user namespaces ({reason}): "
        "start the container with `--privileged`, or grade outside it."
    )
