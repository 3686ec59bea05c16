"""A keyboard for a program that reads one: a terminal of its own, where lines are typed in turn."""

from __future__ import annotations

import contextlib
import fcntl
import itertools
import os
import struct
import termios
from collections.abc import Collection, Iterable, Sequence

MOST_WORDS = 6  # of a program's own
MOST_LINES = 1000  # typed in one run
_USUAL = ("1", "y", "1,1", "1 1")  # a number, a yes, two numbers: whatever may be asked for


def answers(words: Sequence[str], commands: Collection[str]) -> list[list[str]]:
    """Return lines to type, in several orders: if a program ends whichever comes first, none is to blame.

    Args:
        words: the words that the program compares something with.
        commands: the commands that are published; they are not typed, because a reaction to one that was
            typed would be taken for a reaction to the published one.
    """
    said = {command.strip().lower() for command in commands}
    own = [
        word
        for word in words
        if word.isprintable() and not word.startswith("__") and word.strip().lower() not in said
    ]
    lines = [*_USUAL, *own[:MOST_WORDS]]
    return [[*lines[number:], *lines[:number]] for number in range(len(lines))]


def is_ended_by_one(places: Iterable[str | int]) -> bool:
    """Return whether a program ended without an error after several numbers of answers: one ends it."""
    return sum(isinstance(place, int) for place in places) > 1


class Keyboard:
    """A terminal at which lines are typed, again and again in the same order.

    Args:
        lines: the lines to type.

    Attributes:
        stdin: the file descriptor that a program reads from.
        typed: the lines that were typed.
    """

    def __init__(self, lines: Sequence[str]) -> None:
        self._ours, self.stdin = os.openpty()
        self._lines = itertools.cycle(lines)
        self.typed: list[str] = []
        settings = termios.tcgetattr(self.stdin)
        settings[3] &= ~termios.ECHO  # what is typed must not show up as output
        termios.tcsetattr(self.stdin, termios.TCSANOW, settings)
        os.set_blocking(self._ours, False)

    def type(self) -> None:
        """Type a line, if all lines before it were read."""
        if self.stdin < 0:
            return
        waiting = struct.unpack("i", fcntl.ioctl(self.stdin, termios.FIONREAD, b"\0" * 4))[0]
        if not waiting and len(self.typed) < MOST_LINES:
            line = next(self._lines)
            with contextlib.suppress(OSError):  # the program may have done anything to it
                os.write(self._ours, f"{line}\n".encode())
                self.typed.append(line)

    def close(self) -> None:
        """Close the terminal; closing it again does nothing."""
        for number in (self._ours, self.stdin):
            if number >= 0:
                os.close(number)
        self._ours = self.stdin = -1
