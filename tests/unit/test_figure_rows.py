"""The statistics and verdicts behind the table of figures."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))
from row import Quantity, Row, percentile


def test_the_percentile_is_a_sample() -> None:
    """It is the smallest sample that so many of the samples do not exceed, in whatever order they come."""
    assert percentile([3.0, 1.0, 2.0], 50) == 2.0
    assert percentile(list(range(200, 0, -1)), 99) == 198
    assert percentile([7.0], 99) == 7.0


def test_samples_are_summarized_by_median_and_p99() -> None:
    """One slow sample does not move the median."""
    quantity = Quantity.of_samples([1.0, 2.0, 90.0], "ms")
    assert (quantity.value, quantity.p99, quantity.count) == (2.0, 90.0, 3)
    with pytest.raises(ValueError, match="no samples"):
        Quantity.of_samples([], "ms")


@pytest.mark.parametrize(
    ("limits", "is_met"),
    [
        ({}, None),
        ({"value": 10.0}, True),
        ({"value": 9.9}, False),
        ({"value": 10.0, "p99": 40.0}, True),
        ({"value": 10.0, "p99": 39.0}, False),
        ({"ratio": 2.0}, True),
        ({"ratio": 1.9}, False),
    ],
)
def test_a_row_is_met_if_every_limit_is_kept(limits: dict[str, float], is_met: bool | None) -> None:
    row = Row("what", Quantity(10.0, "ms", 40.0, 200), "peer", Quantity(5.0, "ms"), limits)
    assert row.is_met is is_met


def test_a_ratio_to_nothing_is_not_kept() -> None:
    """A peer that was not measured, or is zero, gives no ratio; a limit on it is then missed."""
    for peer in (None, Quantity(0.0, "ms")):
        row = Row("what", Quantity(10.0, "ms"), "peer", peer, {"ratio": 3.0})
        assert row.ratio is None
        assert row.is_met is False
