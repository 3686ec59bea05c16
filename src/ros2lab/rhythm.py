"""When messages come: the time between them, and whether it is the one that was asked for.

The lessons, the demo, the diagnosis and the grader all ask here, so that the same period is right everywhere.
"""

from __future__ import annotations

import itertools
import statistics
from collections.abc import Sequence

TOLERANCE = 0.1  # of the period that is asked for, by which one may be off
UNCERTAINTY = 0.01  # of the same, by which a measurement may be off
LEAST_TOLERANCE = 0.02  # s, for what a busy machine makes of a short one
_GRAIN = 0.05  # of the same, to which a period is rounded where it is told


def median_gap(times: Sequence[float]) -> float | None:
    """Return the median time from one message to the next; None for fewer than two."""
    gaps = [later - earlier for earlier, later in itertools.pairwise(times)]
    return statistics.median(gaps) if gaps else None


def rounded(period: float, wanted: float) -> float:
    """Return a period as it is told beside the one that is asked for; both in s."""
    grain = _GRAIN * wanted
    return round(round(period / grain) * grain, 6)


def has_period(found: float | None, wanted: float) -> bool:
    """Return whether a measured period is the one that is asked for; both in s."""
    if found is None:
        return False
    return abs(found - wanted) <= max((TOLERANCE + UNCERTAINTY) * wanted, LEAST_TOLERANCE)
