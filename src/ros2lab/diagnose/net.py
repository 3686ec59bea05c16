"""A net below the rules: one that fails at somebody's code costs what it would have found, and nothing else.

In the tests it is taken away, for such a failure is a fault of ours that must be seen.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Concatenate, ParamSpec

from ros2lab.diagnose.finding import UNKNOWN, Finding

STRICT = "ROS2LAB_STRICT"  # the variable that takes the net away
ENTANGLED = "This code is too entangled to follow: a class or a value leads through hundreds of others."
_TOO_LONG = "This code cannot be followed: a name in it is longer than that of any file or folder."

_Given = ParamSpec("_Given")


class Unjudged(Finding):
    """What is said instead of the findings of a rule that has failed: of the code it says nothing."""


def guarded(
    rule: Callable[_Given, Iterable[Finding]], *given: _Given.args, **named: _Given.kwargs
) -> Iterator[Finding]:
    """Yield what a rule finds; where it fails, one that says so."""
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
    """Return a finding as something changes it; as it is, where that fails."""
    try:
        return change(finding, *given, **named)
    except Exception as error:
        unjudged(error)
        return finding


def unjudged(error: Exception) -> Unjudged:
    """Return what is said where a rule has failed.

    Raises:
        Exception: the error itself, if it is a fault of ours and the net was taken away.
    """
    is_fault = is_ours(error)
    if is_fault and os.environ.get(STRICT):
        raise error
    fix = "please report it, with the file in question" if is_fault else ""
    return Unjudged(UNKNOWN, why(error), "", fix)


def is_ours(error: Exception) -> bool:
    """Return whether a failure is a fault of ours, and not of code that nobody can follow."""
    is_too_long = isinstance(error, OSError) and error.errno == errno.ENAMETOOLONG
    return not is_too_long and not isinstance(error, (RecursionError, MemoryError))


def why(error: Exception) -> str:
    """Return in a sentence why a rule has failed."""
    if not is_ours(error):
        return _TOO_LONG if isinstance(error, OSError) else ENTANGLED
    place = error.__traceback__
    while place and place.tb_next:
        place = place.tb_next
    where = f", {Path(place.tb_frame.f_code.co_filename).name} line {place.tb_lineno}" if place else ""
    return (
        "Not all of this code was checked: one of ros2lab's own rules failed on it, which is not the code's fault "
        f"({type(error).__name__}{where})."
    )
