"""The thread that redraws."""

from __future__ import annotations

import contextvars
import threading
from collections.abc import Iterator

import pytest
from stand_in_session import StandInSession

from deadlines import DEADLINE
from ros2lab.widgets.redraw import THREAD_NAME, Redraw, redraw_of


@pytest.fixture
def redraw() -> Iterator[Redraw]:
    redraw = Redraw()
    yield redraw
    redraw.close()


class Counter:
    """A draw function that tells when it was called often enough, and by which threads."""

    def __init__(self, enough: int = 3) -> None:
        self.enough = enough
        self.threads: list[str] = []
        self.is_enough = threading.Event()

    def __call__(self) -> None:
        self.threads.append(threading.current_thread().name)
        if len(self.threads) >= self.enough:
            self.is_enough.set()


def test_everything_is_drawn_again_and_again_by_one_thread(redraw: Redraw) -> None:
    first, second = Counter(), Counter()
    redraw.add(first, 100)
    redraw.add(second, 50)
    assert first.is_enough.wait(DEADLINE)
    assert second.is_enough.wait(DEADLINE)
    assert {*first.threads, *second.threads} == {THREAD_NAME}
    assert [thread.name for thread in threading.enumerate()].count(THREAD_NAME) == 1


def test_a_draw_that_raises_is_remembered_once_and_disturbs_no_other(
    redraw: Redraw, capfd: pytest.CaptureFixture[str]
) -> None:
    counter = Counter()

    def failing() -> None:
        counter()
        raise ValueError("no ink")

    other = Counter()
    redraw.add(failing, 100)
    redraw.add(other, 100)
    assert counter.is_enough.wait(DEADLINE)
    other.is_enough.clear()
    assert other.is_enough.wait(DEADLINE)
    redraw.close()
    assert [(type(error.exception), str(error.exception)) for error in redraw.errors] == [
        (ValueError, "no ink")
    ]
    assert "failing" in redraw.errors[0].node_name
    assert "no ink" in redraw.errors[0].traceback
    assert capfd.readouterr() == ("", "")


def test_what_is_removed_is_not_running_when_remove_returns(redraw: Redraw) -> None:
    is_drawing, may_end, has_ended = threading.Event(), threading.Event(), threading.Event()

    def slow() -> None:
        is_drawing.set()
        may_end.wait(DEADLINE)
        has_ended.set()

    redraw.add(slow, 100)
    assert is_drawing.wait(DEADLINE)
    threading.Timer(0.05, may_end.set).start()
    redraw.remove(slow)
    assert has_ended.is_set()
    is_drawing.clear()
    other = Counter()
    redraw.add(other, 100)
    assert other.is_enough.wait(DEADLINE)
    assert not is_drawing.is_set()


def test_a_draw_may_remove_itself_and_end_the_thread(redraw: Redraw) -> None:
    is_done = threading.Event()

    def last() -> None:
        redraw.remove(last)
        redraw.close()
        is_done.set()

    redraw.add(last, 100)
    assert is_done.wait(DEADLINE)
    assert redraw.errors == ()


def test_removing_what_is_unknown_and_closing_twice_do_no_harm(redraw: Redraw) -> None:
    redraw.remove(print)
    redraw.close()
    redraw.close()
    assert redraw.is_closed


def test_draws_run_in_the_context_of_the_cell_that_began() -> None:
    """The browser's answers follow it: those of a newer cell, or page, may lead to where nobody is any more."""
    cell = contextvars.ContextVar("cell", default="none")
    cell.set("first")
    redraw = Redraw()
    cell.set("second")
    seen: list[str] = []
    counter = Counter(1)

    def look() -> None:
        seen.append(cell.get())
        counter()

    redraw.add(look, 100)
    assert counter.is_enough.wait(DEADLINE)
    redraw.close()
    assert set(seen) == {"first"}


@pytest.mark.parametrize("rate", [0, -1, float("nan")])
def test_a_rate_that_is_not_above_zero_is_refused(redraw: Redraw, rate: float) -> None:
    with pytest.raises(ValueError, match="above 0 Hz"):
        redraw.add(print, rate)


def test_a_session_has_one_thread_which_ends_with_it() -> None:
    session = StandInSession()
    redraw = redraw_of(session)
    assert redraw_of(session) is redraw
    session.close()
    assert redraw.is_closed
    assert THREAD_NAME not in [thread.name for thread in threading.enumerate()]


def test_a_closed_session_gets_no_thread() -> None:
    session = StandInSession()
    session.close()
    with pytest.raises(RuntimeError, match="closed"):
        redraw_of(session)
    assert THREAD_NAME not in [thread.name for thread in threading.enumerate()]
