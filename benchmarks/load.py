"""What a process takes of the machine."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import psutil

STEP = 0.2  # s


def processor_load(pids: Sequence[int], seconds: float, advance: Callable[[float], None]) -> float:
    """Return the processor time that processes take together in the next `seconds`, in % of one core.

    Args:
        pids: the processes; all their threads count.
        seconds: how long is measured.
        advance: is told the part that is done, 0 to 1.
    """
    processes = [psutil.Process(pid) for pid in pids]
    begin, busy_before = time.monotonic(), _busy(processes)
    while (passed := time.monotonic() - begin) < seconds:
        time.sleep(STEP)
        advance(min(1.0, passed / seconds))
    return 100 * (_busy(processes) - busy_before) / (time.monotonic() - begin)


def _busy(processes: Sequence[psutil.Process]) -> float:
    times = [process.cpu_times() for process in processes]
    return float(sum(one.user + one.system for one in times))
