"""What a process takes of the machine."""

from __future__ import annotations

import time
from collections.abc import Callable

import psutil

STEP = 0.2  # s


def processor_load(pid: int, seconds: float, advance: Callable[[float], None]) -> float:
    """Return the processor time that a process takes in the next `seconds`, in % of one core.

    Args:
        pid: the process; all its threads count.
        seconds: how long is measured.
        advance: is told the part that is done, 0 to 1.
    """
    process = psutil.Process(pid)
    begin, busy_before = time.monotonic(), _busy(process)
    while (passed := time.monotonic() - begin) < seconds:
        time.sleep(STEP)
        advance(min(1.0, passed / seconds))
    return 100 * (_busy(process) - busy_before) / (time.monotonic() - begin)


def _busy(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)
