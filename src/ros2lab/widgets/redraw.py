"""One thread a session that redraws its widgets, each part at a fixed rate of its own.

A ROS callback only stores the newest values; what shows them is called here, however often they come.
"""

from __future__ import annotations

import contextvars
import functools
import math
import threading
import time
import traceback
import weakref
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING

from ros2lab.executor import NodeError

if TYPE_CHECKING:
    from ros2lab.session import LabSession

Draw = Callable[[], None]

THREAD_NAME = "ros2lab-redraw"
CLOSE_TIMEOUT = 2.0  # s

_of_session: weakref.WeakKeyDictionary[LabSession, Redraw] = weakref.WeakKeyDictionary()


def redraw_of(session: LabSession) -> Redraw:
    """Return the session's one redraw thread; it ends with the session.

    Raises:
        RuntimeError: if the session is closed.
    """
    redraw = _of_session.get(session)
    if redraw is None or redraw.is_closed:
        redraw = Redraw()
        try:
            session.on_close(redraw.close)
        except BaseException:
            redraw.close()
            raise
        _of_session[session] = redraw
    return redraw


def _always() -> bool:
    return True


class Redraw:
    """Calls draw functions at fixed rates, all from one daemon thread.

    A draw function that raises is called again at its next turn, and the others are not disturbed.

    Args:
        name: of the thread.
    """

    def __init__(self, name: str = THREAD_NAME) -> None:
        self._changed = threading.Condition()
        self._jobs: dict[Draw, _Job] = {}
        self._drawing = threading.Lock()
        self._errors: deque[NodeError] = deque(maxlen=100)
        self._is_closed = False
        # In the context of the cell that began it: ipykernel sends the browser's answers to a message where its
        # parent came from, and the newest parent may come from a page, and a subshell, that is gone by then.
        run = functools.partial(contextvars.copy_context().run, self._run)
        self._thread = threading.Thread(target=run, name=name, daemon=True)
        self._thread.start()

    @property
    def is_closed(self) -> bool:
        """Whether the thread was told to end."""
        return self._is_closed

    @property
    def errors(self) -> tuple[NodeError, ...]:
        """What draw functions raised, oldest first; one that repeats itself is kept once."""
        return tuple(self._errors)

    def add(self, draw: Draw, rate: float, *, while_: Callable[[], bool] = _always) -> None:
        """Call `draw` `rate` times a second from now on.

        Args:
            draw: takes and returns nothing, and is quick.
            rate: in Hz.
            while_: a turn at which this is false is left out.

        Raises:
            ValueError: if the rate is not above zero.
        """
        if not rate > 0:
            raise ValueError(f"The redraw rate must be above 0 Hz, not {rate!r}.")
        with self._changed:
            self._jobs[draw] = _Job(draw, 1 / rate, while_)
            self._changed.notify()

    def hurry(self, draw: Draw, wait: float = 0.0) -> None:
        """Call `draw` once before its turn, but not more than twice as often as at its rate.

        Args:
            draw: as it was added; an unknown one is ignored.
            wait: after how many s; an earlier turn is not put off.
        """
        with self._changed:
            job = self._jobs.get(draw)
            if job is not None:
                job.due = min(job.due, max(time.monotonic() + wait, job.called + job.period / 2))
                self._changed.notify()

    def remove(self, draw: Draw) -> None:
        """Stop calling `draw`; when this returns, it is not running any more. An unknown one is ignored."""
        with self._changed:
            self._jobs.pop(draw, None)
        if threading.current_thread() is not self._thread and self._drawing.acquire(timeout=CLOSE_TIMEOUT):
            self._drawing.release()

    def close(self) -> None:
        """End the thread. Closing twice does no harm."""
        with self._changed:
            self._is_closed = True
            self._jobs.clear()
            self._changed.notify()
        if threading.current_thread() is not self._thread:
            self._thread.join(CLOSE_TIMEOUT)

    def _run(self) -> None:
        while (job := self._next()) is not None:
            with self._drawing:
                # It may have been removed since its turn came.
                if self._jobs.get(job.draw) is job and job.while_():
                    self._call(job.draw)

    def _next(self) -> _Job | None:
        """Wait for the next turn and return whose it is, or None at the end."""
        with self._changed:
            while not self._is_closed:
                job = min(self._jobs.values(), key=lambda job: job.due, default=None)
                now = time.monotonic()
                if job is not None and job.due <= now:
                    job.called = now
                    job.wait_for_next_turn()
                    return job
                self._changed.wait(None if job is None else job.due - now)
        return None

    def _call(self, draw: Draw) -> None:
        try:
            draw()
        except Exception as exception:
            # Printed from here it would land in whichever cell runs.
            name = getattr(draw, "__qualname__", repr(draw))
            error = NodeError(name, exception, traceback.format_exc(), time.monotonic())
            if all((error.node_name, error.traceback) != (e.node_name, e.traceback) for e in self._errors):
                self._errors.append(error)


class _Job:
    """A draw function, its period (s), and when it was called and is to be called (s of `time.monotonic()`)."""

    def __init__(self, draw: Draw, period: float, while_: Callable[[], bool]) -> None:
        self.draw = draw
        self.period = period
        self.while_ = while_
        self.called = -math.inf
        self.wait_for_next_turn()

    def wait_for_next_turn(self) -> None:
        """Turns are at multiples of the period, so that those of several jobs wake the thread once.

        One that was missed is not made up for.
        """
        self.due = (time.monotonic() // self.period + 1) * self.period
