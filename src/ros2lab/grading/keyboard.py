"""A keyboard for a program that asks at one: a terminal of its own, at which lines are typed, one after the other."""

from __future__ import annotations

import contextlib
import fcntl
import itertools
import os
import struct
import termios
from collections.abc import Collection, Iterable, Sequence

MOST_WORDS = 6  # of a program's own
MOST_LINES = 1000  # that are typed in one run
_USUAL = ("1", "y", "1,1", "1 1")  # a number, a yes, two numbers: whatever may be asked for


def answers(words: Sequence[str], commands: Collection[str]) -> list[list[str]]:
    """Return what may be typed, in several orders: what ends a program whichever comes first is not the answer's fault.

    Args:
        words: with which the program compares something.
        commands: that are published; what follows one that was typed would be taken for an answer to it.
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
    """Return whether a program has ended without an error behind several numbers of answers: one ends it, and will again."""
    return sum(isinstance(place, int) for place in places) > 1


class Keyboard:
    """A terminal at which lines are typed, again and again in the same order.

    Args:
        lines: that are typed.

    Attributes:
        stdin: the file descriptor that a program reads from.
        typed: what was typed.
    """

    def __init__(self, lines: Sequence[str]) -> None:
        self._ours, self.stdin = os.openpty()
        self._lines = itertools.cycle(lines)
        self.typed: list[str] = []
        settings = termios.tcgetattr(self.stdin)
        settings[3] &= ~termios.ECHO  # what is typed is no output of the program
        termios.tcsetattr(self.stdin, termios.TCSANOW, settings)
        os.set_blocking(self._ours, False)

    def type(self) -> None:
        """Type a line, if all before it was read."""
        if self.stdin < 0:
            return
        waiting = struct.unpack("i", fcntl.ioctl(self.stdin, termios.FIONREAD, b"\0" * 4))[0]
        if not waiting and len(self.typed) < MOST_LINES:
            line = next(self._lines)
            with contextlib.suppress(OSError):  # the program may have done anything to it
                os.write(self._ours, f"{line}\n".encode())
                self.typed.append(line)

    def close(self) -> None:
        """Give it back; closing it again does nothing."""
        for number in (self._ours, self.stdin):
            if number >= 0:
                os.close(number)
        self._ours = self.stdin = -1
