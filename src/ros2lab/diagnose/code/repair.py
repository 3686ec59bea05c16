"""A change of one line of a file that Python cannot parse."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Repair:
    """A change of one line after which Python reads on.

    Attributes:
        line: the number of the line.
        new: its new text; empty if it is removed.
        why: what is wrong with it, as a clause.
    """

    line: int
    new: str
    why: str
