"""A meaning of an error message: the words, the faults that cause it, and what to say about it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Meaning:
    """What an error may mean.

    Attributes:
        pattern: matches the message; its groups fill in `cause` and `fix`.
        codes: the faults that may have caused it; a finding with one of these codes explains it best.
        cause: what to say if there is no such finding, with the first code; empty if nothing is to be said.
        fix: what to do then; or a function that returns it, with the groups as keyword arguments.
        place: where to look, if no line of code is named.
    """

    pattern: re.Pattern[str]
    codes: tuple[str, ...]
    cause: str = ""
    fix: str | Callable[..., str] = ""
    place: str = ""


def meaning(
    pattern: str, codes: str, cause: str = "", fix: str | Callable[..., str] = "", place: str = ""
) -> Meaning:
    """Return a meaning for a regular expression; the codes are separated by spaces."""
    return Meaning(re.compile(pattern), tuple(codes.split()), cause, fix, place)
