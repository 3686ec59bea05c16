"""The time between messages, and when it is the one that was asked for."""

from __future__ import annotations

import pytest

from ros2lab.rhythm import distance, has_period, is_another, is_uneven, median_gap, period_of, rounded


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


def test_several_at_a_time_are_one() -> None:
    assert period_of([2.0, 2.001, 4.0, 4.001, 6.0]) == pytest.approx(1.9995, abs=1e-3)
    assert period_of([2.0]) is None


def test_what_comes_now_and_then_has_no_rhythm() -> None:
    """A message may be late by more than a second on a busy machine."""
    assert is_uneven([1.0, 1.5, 5.0])
    assert not is_uneven([2.0, 4.0, 6.6, 8.0])
    assert not is_uneven([2.0, 5.0])


def test_it_is_told_how_far_it_is_off() -> None:
    assert [distance(found, 2.0) for found in (2.2, 2.39, 3.0, 9.0)] == ["right", "close", "off", "far"]


def test_a_period_that_follows_its_parameter_is_another() -> None:
    assert is_another(1.0, 2.0)
    assert not is_another(2.0, 2.2)
