"""How many submissions are graded at once: as many as processors, memory and processes bear."""

from __future__ import annotations

import os
import resource

import psutil

# What is set aside for one grading and its boxes. One node takes 160 MB and 46 threads (measured); several nodes, each
# watched beside the others, and a submission's own tests take a few times as much.
MEMORY = 700_000_000  # bytes
PROCESSES = 150  # and threads
PER_CORE = 1.5  # a grading waits for a part of its time


def automatic() -> int:
    """Return how many submissions this machine bears at once, at least 1."""
    return jobs_for(len(os.sched_getaffinity(0)), psutil.virtual_memory().available, _spare_processes())


def jobs_for(cores: int, memory: int, processes: int) -> int:
    """Return how many submissions so many cores, bytes of memory and processes bear, at least 1."""
    return max(1, min(int(cores * PER_CORE), memory // MEMORY, processes // PROCESSES))


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
