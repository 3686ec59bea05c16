"""How many submissions are graded at once: as many as memory and processes bear, and processors have time for."""

from __future__ import annotations

import os
import resource
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import psutil

# What is set aside for one grading and its boxes. One node takes 160 MB and 46 threads (measured); several nodes, each
# watched beside the others, and a submission's own tests take a few times as much.
MEMORY = 700_000_000  # bytes
PROCESSES = 150  # and threads
PER_CORE = 4  # at most; a grading waits for two thirds of its time (measured), to see what comes later
SPARE = 0.3  # of a processor; where there is less, another grading would only make the others slower
LOOK = 0.5  # s for which is looked how much there is


def spare_processors() -> float:
    """Look for a moment, and return how many of the processors of this process had nothing to do, such as 1.5."""
    busy = psutil.cpu_percent(LOOK, percpu=True)
    return sum(1 - busy[core] / 100 for core in os.sched_getaffinity(0) if core < len(busy))


class Gate:
    """Lets gradings begin one after the other: one for each processor, and further ones where there is time for them."""

    def __init__(self, cores: int | None = None, spare: Callable[[], float] = spare_processors) -> None:
        """Make a gate for the processors of this process; the arguments are for tests."""
        self._cores = cores or len(os.sched_getaffinity(0))
        self._spare = spare
        self._turn = threading.Lock()
        self._changes = threading.Lock()
        self._inside = 0

    @contextmanager
    def passed(self, is_over: Callable[[], bool]) -> Iterator[None]:
        """Wait for one's turn, and for time to spare, or until it is over; then be inside."""
        with self._turn:
            while self._inside >= self._cores and not is_over() and self._spare() < SPARE:
                pass  # each look takes its time
            self._change(1)
        try:
            yield
        finally:
            self._change(-1)

    def _change(self, by: int) -> None:
        with self._changes:
            self._inside += by


def automatic() -> int:
    """Return how many submissions this machine bears at once, at least 1."""
    return jobs_for(len(os.sched_getaffinity(0)), psutil.virtual_memory().available, _spare_processes())


def jobs_for(cores: int, memory: int, processes: int) -> int:
    """Return how many submissions so many cores, bytes of memory and processes bear, at least 1."""
    return max(1, min(cores * PER_CORE, memory // MEMORY, processes // PROCESSES))


def _spare_processes() -> int:
    """Return how many processes and threads this user may still start."""
    allowed, _ = resource.getrlimit(resource.RLIMIT_NPROC)
    if allowed == resource.RLIM_INFINITY or os.getuid() == 0:
        return 1_000_000
    own = 0
    for process in psutil.process_iter(["uids", "num_threads"]):
        if process.info["uids"] and process.info["uids"].real == os.getuid():
            own += process.info["num_threads"] or 1
    return max(0, allowed - own)
