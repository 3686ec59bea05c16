"""How regularly messages came, from their times alone."""

from __future__ import annotations

import pytest

from ros2lab.arrivals import FEWEST, MOST, Arrivals


def arrived(times: list[float]) -> Arrivals:
    arrivals = Arrivals()
    for time in times:
        arrivals.add(time, b"")
    return arrivals


def test_without_a_message_there_is_only_a_count() -> None:
    rhythm = Arrivals().rhythm(5.0)
    assert (rhythm.count, rhythm.rate, rhythm.jitter, rhythm.age) == (0, None, None, None)


def test_rate_jitter_and_age_come_from_the_gaps() -> None:
    rhythm = arrived([0.0, 0.1, 0.3, 0.4]).rhythm(0.5)
    assert rhythm.rate == pytest.approx(7.5)
    assert rhythm.jitter == pytest.approx(0.057735, rel=1e-4)
    assert rhythm.age == pytest.approx(0.1)


def test_one_and_two_messages_have_no_jitter() -> None:
    assert arrived([1.0]).rhythm(1.0).rate is None
    two = arrived([1.0, 1.5]).rhythm(2.0)
    assert (two.rate, two.jitter) == (2.0, None)
    assert arrived([1.0, 1.0]).rhythm(1.0).rate is None


def test_only_the_last_seconds_count_for_the_rate_and_all_for_the_count() -> None:
    slow = [0.5 * n for n in range(100)]
    fast = [50 + 0.01 * n for n in range(2000)]
    rhythm = arrived([*slow, *fast]).rhythm(70.0)
    assert rhythm.rate == pytest.approx(100.0)
    assert rhythm.count == 2100


def test_a_slow_topic_has_a_rate_of_its_last_messages_and_is_waited_for() -> None:
    rhythm = arrived([20.0 * n for n in range(2 * FEWEST)]).rhythm(390.0)
    assert rhythm.rate == pytest.approx(0.05)
    assert rhythm.patience == pytest.approx(80.0)


def test_what_is_kept_is_bounded_and_the_newest_is_there() -> None:
    arrivals = Arrivals()
    for n in range(MOST + 10):
        arrivals.add(1e-4 * n, str(n).encode())
    assert arrivals.newest() == (MOST + 10, str(MOST + 9).encode())
    assert len(arrivals._times) == MOST
