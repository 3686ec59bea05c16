"""How the words of an error are looked up: what they may mean, where to look for its cause, and what to say of it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Meaning:
    """What an error may mean.

    Attributes:
        pattern: the words; its groups fill in `cause` and `fix`.
        codes: what may have caused it; a finding of one of them in the sources explains it best.
        cause: what is said where there is none; the code is then the first one. Empty: nothing is said.
        fix: what to do then; or a function that says it, given the groups by their names.
    """

    pattern: re.Pattern[str]
    codes: tuple[str, ...]
    cause: str = ""
    fix: str | Callable[..., str] = ""


def meaning(pattern: str, codes: str, cause: str = "", fix: str | Callable[..., str] = "") -> Meaning:
    """Return a meaning of the words that a regular expression finds; the codes stand in one text, with spaces between."""
    return Meaning(re.compile(pattern), tuple(codes.split()), cause, fix)
