"""A safety net for the rules: a rule that fails loses its own findings, and nothing else.

The tests remove it, because such a failure is a bug of ours that must be noticed.
"""

from __future__ import annotations

import errno
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Concatenate, ParamSpec

from ros2lab.diagnose.finding import UNKNOWN, Finding

STRICT = "ROS2LAB_STRICT"  # the environment variable that removes the net
ENTANGLED = "This code is too entangled to follow: a class or a value leads through hundreds of others."
_TOO_LARGE = "To read this takes more time than anything that is written by hand."
OURS = "which is not the code's fault"
_TOO_LONG = "This code cannot be followed: a name in it is longer than that of any file or folder."

_Given = ParamSpec("_Given")


class _Late(BaseException):
    """The end of `bounded`, which no rule catches."""


@contextmanager
def bounded(seconds: float) -> Iterator[None]:
    """Raise a TimeoutError in what takes more CPU time; in another thread than the main one it has no bound."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def end(*_: object) -> None:
        raise _Late

    before = signal.signal(signal.SIGVTALRM, end)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds, 0.1)  # again, for what ignores the first one
    try:
        yield
    except _Late:
        raise TimeoutError from None
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


class Unjudged(Finding):
    """A finding instead of those of a rule that failed: it says nothing about the code."""


def guarded(
    rule: Callable[_Given, Iterable[Finding]], *given: _Given.args, **named: _Given.kwargs
) -> Iterator[Finding]:
    """Yield what a rule finds; if the rule fails, a finding that says so."""
    try:
        yield from rule(*given, **named)
    except Exception as error:
        yield unjudged(error)


def changed(
    change: Callable[Concatenate[Finding, _Given], Finding],
    finding: Finding,
    *given: _Given.args,
    **named: _Given.kwargs,
) -> Finding:
    """Return the finding that a function makes of another one; the original if the function fails."""
    try:
        return change(finding, *given, **named)
    except Exception as error:
        unjudged(error)
        return finding


def unjudged(error: Exception) -> Unjudged:
    """Return a finding that says that a rule failed.

    Raises:
        Exception: the error itself, if it is a bug of ours and the net was removed.
    """
    is_fault = is_ours(error)
    if is_fault and os.environ.get(STRICT):
        raise error
    fix = "please report it, with the file in question" if is_fault else ""
    return Unjudged(UNKNOWN, why(error), "", fix)


def is_ours(error: Exception) -> bool:
    """Return whether a failure is a bug of ours, and not due to code that is too entangled to follow."""
    is_too_long = isinstance(error, OSError) and error.errno == errno.ENAMETOOLONG
    return not is_too_long and not isinstance(error, (RecursionError, MemoryError, TimeoutError))


def why(error: Exception) -> str:
    """Return a sentence that says why a rule failed."""
    if not is_ours(error):
        late = _TOO_LARGE if isinstance(error, TimeoutError) else _TOO_LONG
        return late if isinstance(error, OSError) else ENTANGLED
    place = error.__traceback__
    while place and place.tb_next:
        place = place.tb_next
    where = f", {Path(place.tb_frame.f_code.co_filename).name} line {place.tb_lineno}" if place else ""
    return (
        f"Not all of this code was checked: one of ros2lab's own rules failed on it, {OURS} "
        f"({type(error).__name__}{where})."
    )
