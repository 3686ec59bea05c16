"""When messages come: the time between them, and whether it is the one that was asked for.

The lessons, the demo, the diagnosis and the grader all ask here, so that the same period is right everywhere.
"""

from __future__ import annotations

import itertools
import statistics
from collections.abc import Sequence
from typing import Literal

TOLERANCE = 0.1  # of the period that is asked for, by which one may be off
UNCERTAINTY = 0.01  # of the same, by which a measurement may be off
LEAST_TOLERANCE = 0.02  # s, for what a busy machine makes of a short one
CLOSE = 0.25  # of the same, by which a period may be off and still be close
FACTOR = 2.0  # times the period that is asked for, from which one is far off
AT_A_TIME = 0.05  # of the longest time between two messages
UNEVEN = 1.5  # s, between two times from message to message; on a busy machine one can be late
REAL_HORIZON = 5.2  # s on the real clock, for two messages of a 2.4 s timer, whatever its phase
LEAST_CHANGE = 1.3  # times, of a period that follows its parameter
_GRAIN = 0.05  # of the same, to which a period is rounded where it is told


Distance = Literal["right", "close", "off", "far"]


def period_of(times: Sequence[float]) -> float | None:
    """Return the time from one message to the next, where several at a time are one; None for fewer than two."""
    gaps = gaps_apart(times)
    return statistics.median(gaps) if gaps else None


def gaps_apart(times: Sequence[float]) -> list[float]:
    """Return the times between messages without those between several at a time."""
    gaps = between(times)
    return [gap for gap in gaps if gap > AT_A_TIME * max(gaps)]


def between(times: Sequence[float]) -> list[float]:
    """Return the time from each message to the next."""
    return [later - earlier for earlier, later in itertools.pairwise(times)]


def is_uneven(times: Sequence[float]) -> bool:
    """Return whether messages come in no rhythm at all."""
    gaps = gaps_apart(times)
    return len(gaps) > 1 and max(gaps) - min(gaps) > UNEVEN


def distance(period: float, wanted: float) -> Distance:
    """Return how far a period is from the one that is asked for; both in s."""
    if has_period(period, wanted):
        return "right"
    told = rounded(period, wanted)
    if abs(told - wanted) <= CLOSE * wanted:
        return "close"
    return "off" if wanted / FACTOR <= told <= wanted * FACTOR else "far"


def is_another(period: float, other: float) -> bool:
    """Return whether two periods differ by more than chance, as with another value of a parameter."""
    return max(period / other, other / period) >= LEAST_CHANGE


def median_gap(times: Sequence[float]) -> float | None:
    """Return the median time from one message to the next; None for fewer than two."""
    return statistics.median(between(times)) if len(times) > 1 else None


def rounded(period: float, wanted: float) -> float:
    """Return a period as it is told beside the one that is asked for; both in s."""
    grain = _GRAIN * wanted
    return round(round(period / grain) * grain, 6)


def has_period(found: float | None, wanted: float) -> bool:
    """Return whether a measured period is the one that is asked for; both in s."""
    if found is None:
        return False
    return abs(found - wanted) <= max((TOLERANCE + UNCERTAINTY) * wanted, LEAST_TOLERANCE)
