"""A running bubblewrap, and the processes in it."""

# pathlib takes as long to import as all of the others.
# ruff: noqa: PTH110, PTH116

import contextlib
import json
import os
import select
import signal
import time
from collections.abc import Callable, Collection, Iterator

from . import FILES, FOLDER, LIMITS, counted

# What a socket can buffer, which counts as no process's memory: the usual net.core.wmem_default. No socket of
# a box gets more, and a pipe never holds as much.
BYTES_PER_OPEN_FILE = 212_992
# What Linux needs for a map of memory, and for each process with a copy of it: it is in none of their pages.
BYTES_PER_MAP, BYTES_PER_COPY = 448, 64
COUNTING = 0.01  # s to count maps in each look
# They are the machine's, and whoever may write to one may set its times to now, which another box could read.
DEVICES = [f"/dev/{name}" for name in ("null", "zero", "full", "random", "urandom", "tty")]
OWN_PROC = os.stat("/proc").st_dev


class Box:
    """A running bubblewrap."""

    def __init__(self, number: int, pid: int, status: int, limits: dict[str, float]) -> None:
        self.number = number
        self.pid = pid
        self.ended = os.pidfd_open(pid)
        self.status = status  # the pipe on which bubblewrap reports the first process of the box, and its end
        self.told = b""
        self.init = 0  # process number of the box's first process
        self.init_handle = -1
        self.limits = limits
        self.start = time.monotonic()
        # The last CPU seconds of each process, and of those that it has waited for, by number and start.
        self.cpu_of: dict[tuple[bytes, bytes], tuple[float, float]] = {}
        self.cpu_of_gone = 0.0
        self.memory, self.slots = 0, 0  # bytes of its processes, and the most open files that they may have
        self.maps: dict[str, int] = {}  # the last count of each process; the latest one comes last
        self.cut: str | None = None
        self.fault = ""
        self.is_doomed = False
        self.is_to_stand = False
        self.is_interrupted = self.was_interrupted = False

    @property
    def root(self) -> str:
        """The box's own root folder, seen from outside."""
        return f"/proc/{self.init}/root"

    @property
    def processes_folder(self) -> str:
        """The box's own /proc."""
        return f"{self.root}/proc"

    def read_status(self) -> None:
        """Read what bubblewrap has reported so far."""
        while select.select([self.status], [], [], 0)[0] and (part := os.read(self.status, 4096)):
            self.told += part
        if not self.init and b"\n" in self.told:
            self.init = json.loads(self.told.split(b"\n")[0])["child-pid"]
            with contextlib.suppress(ProcessLookupError):
                self.init_handle = os.pidfd_open(self.init)

    def look(self, free: int, sockets: int, adrift: Callable[[], int]) -> None:
        """Compare what the box uses with its limits.

        Args:
            free: the bytes of memory that this machine can still give.
            sockets: the number of sockets in the World.
            adrift: returns the bytes of memory in the World that no process of a box holds any more.
        """
        if self.is_doomed:
            return
        self.cut = self._reason(sockets, adrift)
        if self.cut is None and free < self.limits["spare_bytes"]:
            self.fault = "This machine has too little memory left"
        self.is_doomed = bool(self.cut or self.fault)

    def act(self) -> None:
        """Carry out what was asked for, or what a limit requires."""
        if not self.init:
            self.read_status()
        if self.is_doomed and self.init_handle >= 0:
            with contextlib.suppress(ProcessLookupError):
                signal.pidfd_send_signal(self.init_handle, signal.SIGKILL)
        elif self.is_interrupted and self._has_started():
            self.is_interrupted, self.was_interrupted = False, True
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.init, signal.SIGINT)  # the first process of a process namespace ignores it

    def has_come_to_stand(self) -> bool:
        """Stop all processes in the box, if that was asked for; return whether all of them have stopped."""
        if self.is_to_stand and self._has_started() and not any([*self._signal_all(signal.SIGSTOP)]):
            self.is_to_stand = False
            return True
        return False

    def release(self) -> None:
        """Resume all processes in the box."""
        self.is_to_stand = False
        if self._has_started():
            _ = [*self._signal_all(signal.SIGCONT)]

    def _signal_all(self, number: int) -> Iterator[bool]:
        """Send a signal to all processes but the first; yield for each whether it was still running."""
        for name in counted.numbers(self.processes_folder):
            with contextlib.suppress(OSError):
                process = os.open(f"{self.processes_folder}/{name}", os.O_RDONLY | os.O_DIRECTORY)
                try:
                    if name != "1":
                        yield counted.is_running(f"/proc/self/fd/{process}")
                        signal.pidfd_send_signal(process, number)
                finally:
                    os.close(process)

    def _reason(self, sockets: int, adrift: Callable[[], int]) -> str | None:
        """Return a sentence on the limit that it exceeds; None if it keeps to all of them."""
        limit = self.limits
        if time.monotonic() - self.start > limit["wall_s"]:
            return LIMITS["time"].format(limit["wall_s"])
        if not self._has_started():
            return None
        with contextlib.suppress(OSError):  # it has just ended
            processes = self._processes()
            if self._cpu_s(processes) > limit["cpu_s"]:
                return LIMITS["cpu"].format(limit["cpu_s"])
            if self._is_over_memory(processes, sockets, adrift):
                return LIMITS["memory"].format(limit["memory_bytes"] / 1e6)
            folders = (f"{self.root}/tmp", f"{self.root}/dev/shm", FILES)  # noqa: S108 -- the box's own
            if any(map(counted.has_too_many_files, folders)):
                return LIMITS["files"]
        return None

    def _has_started(self) -> bool:
        """Return whether the box has its own /proc, instead of the machine's, and its program has started."""
        try:
            is_own = bool(self.init) and os.stat(self.processes_folder).st_dev != OWN_PROC
            return is_own and os.path.exists(f"{self.processes_folder}/2")
        except OSError:
            return False

    def _cpu_s(self, processes: Collection[str]) -> float:
        """Return the CPU seconds of all its processes.

        Those of a process that has ended are added to its parent's if the parent waits for it. If it does
        not, they count as they were last seen.
        """
        seen = {key: seconds for process in processes for key, seconds in counted.cpu_s(process)}
        self.cpu_of_gone += sum(own for key, (own, _) in self.cpu_of.items() if key not in seen)
        self.cpu_of = seen
        own, waited_for = map(sum, zip(*seen.values(), strict=True)) if seen else (0.0, 0.0)
        return own + max(waited_for, self.cpu_of_gone)

    def _is_over_memory(self, processes: Collection[str], sockets: int, adrift: Callable[[], int]) -> bool:
        """Return whether its processes hold too much; what takes long is counted only if it may matter."""
        most = self.limits["memory_bytes"]
        held = {process: counted.memory(process) for process in processes}
        memory, slots, pages = map(sum, zip(*held.values(), strict=True)) if held else (0, 0, 0)
        self.memory, self.slots = memory, slots
        of_a_map = BYTES_PER_MAP + BYTES_PER_COPY * len(held)
        if memory + (slots + sockets) * BYTES_PER_OPEN_FILE + pages * of_a_map <= most:
            return False
        memory += self._count_maps(held) * of_a_map
        return memory + self.descriptors() * BYTES_PER_OPEN_FILE + adrift() > most

    def _count_maps(self, processes: Collection[str]) -> int:
        """Return how many maps of memory processes have; each call counts some processes anew, in turn."""
        waiting = [name for name in processes if name not in self.maps]
        waiting += [name for name in self.maps if name in processes]
        self.maps = {name: self.maps.get(name, 0) for name in waiting}
        end = time.monotonic() + COUNTING
        for name in waiting:
            del self.maps[name]
            self.maps[name] = counted.maps(name)
            if time.monotonic() > end:
                break
        return sum(self.maps.values())

    def descriptors(self) -> int:
        """Return how many open files all its processes have together."""
        return sum(map(counted.descriptors, self._processes())) if self._has_started() else 0

    def _processes(self) -> list[str]:
        """Return the folders of all its processes once the program has started; empty when it has ended."""
        return [f"{self.processes_folder}/{name}" for name in counted.numbers(self.processes_folder)]


def started(number: int, command: list[str], passed: list[int], limits: dict[str, float]) -> Box:
    """Start bubblewrap with `command`; the open files in `passed` are its output and, if given, its input."""
    for device in DEVICES:
        with contextlib.suppress(OSError):  # if this user may not, no box may
            os.utime(device)
    output, *given = passed
    status, its_status = os.pipe()
    its_filter, nothing = (os.open(path, os.O_RDONLY) for path in (f"{FOLDER}/filter", os.devnull))
    for descriptor in (its_status, its_filter):
        os.set_inheritable(descriptor, True)
    options = ["--json-status-fd", str(its_status), "--seccomp", str(its_filter)]
    try:
        pid = os.posix_spawn(
            command[0],
            [command[0], *options, *command[1:]],
            {},
            file_actions=[
                (os.POSIX_SPAWN_DUP2, given[0] if given else nothing, 0),
                *((os.POSIX_SPAWN_DUP2, output, n) for n in (1, 2)),
            ],
            setsigdef=[n for n in signal.valid_signals() if n not in (signal.SIGKILL, signal.SIGSTOP)],
            setsigmask=[],
        )
    except (OSError, ValueError):
        os.close(status)
        raise
    finally:
        for descriptor in (its_status, its_filter, nothing):
            os.close(descriptor)
    return Box(number, pid, status, limits)
