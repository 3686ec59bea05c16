"""One row of the table of figures: what was measured, beside what, and whether that is enough."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Quantity:
    """Something measured.

    Attributes:
        value: the median, or the only value.
        unit: of `value` and `p99`.
        p99: the value that 99 of 100 samples do not exceed; None where there is one value only.
        count: how many samples there were.
    """

    value: float
    unit: str
    p99: float | None = None
    count: int = 1

    @classmethod
    def of_samples(cls, samples: Sequence[float], unit: str) -> Quantity:
        """Summarize samples (any order).

        Raises:
            ValueError: if there are none.
        """
        if not samples:
            raise ValueError(f"There are no samples (in {unit}) to take the median of.")
        return cls(statistics.median(samples), unit, percentile(samples, 99), len(samples))

    def __str__(self) -> str:
        if self.p99 is None:
            return f"{self.value:.3g} {self.unit}" if self.value < 1000 else f"{self.value:.0f} {self.unit}"
        return f"{self.value:.2f}, p99 {self.p99:.2f} {self.unit}"


@dataclass(frozen=True)
class Row:
    """A figure, what it is compared with, and what it should be.

    Attributes:
        what: what was measured.
        measured: the figure.
        peer_name: what it is compared with: a floor below which it cannot be, or another way to do the same.
        peer: the same quantity of the peer, None if it was not measured.
        limits: the largest allowed `value`, `p99` and `ratio` to the peer; those not named are free.
        note: where it comes from, in a line.
    """

    what: str
    measured: Quantity
    peer_name: str = ""
    peer: Quantity | None = None
    limits: Mapping[str, float] = field(default_factory=dict)
    note: str = ""

    @property
    def ratio(self) -> float | None:
        """How many times the peer's value the measured one is; None where that cannot be said."""
        return self.measured.value / self.peer.value if self.peer and self.peer.value else None

    @property
    def target(self) -> str:
        """The limits in words."""
        names = {"value": "median" if self.measured.p99 is not None else ""}
        texts = []
        for name, most in self.limits.items():
            unit = "" if name == "ratio" else f" {self.measured.unit}"
            texts.append(f"{names.get(name, name)} ≤ {most:g}{unit}".strip())
        return ", ".join(texts)

    @property
    def is_met(self) -> bool | None:
        """Whether every limit is kept; None if there is none."""
        found = {"value": self.measured.value, "p99": self.measured.p99, "ratio": self.ratio}
        kept = [(found[name] is not None and found[name] <= most) for name, most in self.limits.items()]
        return all(kept) if kept else None

    def as_data(self) -> dict[str, Any]:
        """Return the row as what JSON can hold."""
        return {
            "what": self.what,
            "measured": vars(self.measured),
            "peer_name": self.peer_name,
            "peer": vars(self.peer) if self.peer else None,
            "ratio": self.ratio,
            "limits": dict(self.limits),
            "is_met": self.is_met,
            "note": self.note,
        }


def percentile(samples: Sequence[float], percent: float) -> float:
    """Return the smallest sample that `percent` of 100 samples do not exceed."""
    ordered = sorted(samples)
    return ordered[max(0, math.ceil(len(ordered) * percent / 100) - 1)]
