"""Which share of a processor a program has on this machine now, so that a wait for it can last longer on a busy one."""

from __future__ import annotations

import os
from pathlib import Path

_LEAST = 1 / 4  # so that none takes more than four times as long
_LOADS = Path("/proc/loadavg")  # its fourth word: how many tasks run or wait for a processor, of how many


def processor_share() -> float:
    """Return the share that one more program has, between a quarter and 1; 1 where Linux does not tell.

    Who sleeps most of the time gets a processor at once whenever it wakes: its own delays do not show how long
    others wait, who compute.
    """
    try:
        runnable = int(_LOADS.read_text(encoding="ascii").split()[3].partition("/")[0])
    except (OSError, IndexError, ValueError):
        return 1.0
    others = max(1, runnable - 1)  # this process is one of them
    return max(_LEAST, min(1.0, len(os.sched_getaffinity(0)) / others))
