"""The time between messages, and when it is the one that was asked for."""

from __future__ import annotations

import pytest

from ros2lab.rhythm import has_period, median_gap, rounded


def test_the_median_is_not_moved_by_one_late_message() -> None:
    assert median_gap([0.0, 2.0, 4.0, 9.0]) == 2.0
    assert median_gap([1.0]) is None


@pytest.mark.parametrize("wanted", [0.5, 1.0, 2.0, 5.0])
def test_a_tenth_may_be_missing(wanted: float) -> None:
    right = [0.9, 0.95, 1.0, 1.1, 1.105]
    wrong = [0.0, 0.5, 0.87, 1.12, 1.195, 2.0, 1000.0]
    assert [has_period(share * wanted, wanted) for share in right] == [True] * len(right)
    assert [has_period(share * wanted, wanted) for share in wrong] == [False] * len(wrong)
    assert not has_period(None, wanted)


def test_what_a_busy_machine_makes_of_a_short_period_is_right() -> None:
    assert has_period(0.119, 0.1)
    assert has_period(0.081, 0.1)
    assert not has_period(0.13, 0.1)


def test_it_is_told_rounded() -> None:
    assert rounded(1.0421, 2.0) == 1.0
    assert rounded(0.0123, 0.1) == 0.01
