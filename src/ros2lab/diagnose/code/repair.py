"""A change of a file that Python cannot parse."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

USUAL, SELDOM, RARE = 1.0, 1.5, 2.5  # costs


@dataclass(frozen=True)
class Repair:
    """A change of one line, or of the indentation of several, after which Python may read on.

    Attributes:
        new: its new text; empty if it is removed.
        why: what is wrong with it, as a clause.
        cost: the higher, the less likely the slip is that it undoes.
        below: the new texts of the lines below it that move along with it.
    """

    line: int
    new: str
    why: str
    cost: float = USUAL
    below: tuple[str, ...] = ()
    is_move: bool = False

    @property
    def last(self) -> int:
        """The number of the last line that changes."""
        return self.line + len(self.below)

    def applied(self, lines: Sequence[str]) -> list[str]:
        """Return the lines of a file with the change."""
        return [*lines[: self.line - 1], self.new, *self.below, *lines[self.last :]]
