"""Rates and gaps are computed from times alone."""

from __future__ import annotations

import pytest

from ros2lab.topics import Sample, Statistics


def of(*times: float) -> Statistics:
    return Statistics.of([Sample(time, f"at {time}", time) for time in times], count=len(times))


def test_regular_messages() -> None:
    """Ten messages, 0.1 s apart, are 10 Hz with no deviation."""
    found = of(*(n / 10 for n in range(10)))
    assert found.count == 10
    assert found.rate == pytest.approx(10.0)
    assert found.mean_gap == pytest.approx(0.1)
    assert found.largest_gap == pytest.approx(0.1)
    assert found.gap_std == pytest.approx(0.0, abs=1e-12)
    assert found.last == "at 0.9"


def test_a_pause_is_the_largest_gap() -> None:
    """One gap of a second among short ones is found; the mean is over all."""
    found = of(0.0, 0.5, 1.5, 2.0)
    assert found.largest_gap == 1.0
    assert found.mean_gap == pytest.approx(2 / 3)
    assert found.rate == pytest.approx(1.5)
    assert found.gap_std == pytest.approx(0.288675, abs=1e-6)


@pytest.mark.parametrize("n", [0, 1])
def test_too_few_messages_have_no_rate(n: int) -> None:
    """What cannot be known is None, not zero."""
    found = of(*range(n))
    assert (found.rate, found.mean_gap, found.largest_gap, found.gap_std) == (None, None, None, None)
    assert found.count == n


def test_messages_at_the_same_instant_have_no_rate() -> None:
    """A mean gap of zero is told as such; an infinite rate is not invented."""
    assert of(1.0, 1.0).mean_gap == 0.0
    assert of(1.0, 1.0).rate is None
