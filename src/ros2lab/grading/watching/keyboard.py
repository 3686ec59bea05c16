"""A keyboard for a program that reads one: a terminal of its own, where lines are typed in turn."""

from __future__ import annotations

import contextlib
import fcntl
import itertools
import os
import struct
import termios
from collections.abc import Collection, Sequence

MOST_WORDS = 6  # of a program's own
MOST_LINES = 1000  # typed in one run
MOST_RUNS = 10  # until a program goes on
_USUAL = ("1", "y", "1,1", "1 1")  # a number, a yes, two numbers: whatever may be asked for


def answers(words: Sequence[str], commands: Collection[str]) -> list[str]:
    """Return the lines to type.

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
    return [*_USUAL, *own[:MOST_WORDS]]


class Search:
    """The search for what to type, so that a program goes on.

    Args:
        lines: the lines that may be typed.

    Attributes:
        keys: the lines to type next time; empty if a program ends whatever is typed.
    """

    def __init__(self, lines: Sequence[str]) -> None:
        self.keys = [*lines]
        self._lines, self._left = lines, MOST_RUNS
        self._harmless = [*lines]
        self._tried: dict[tuple[str, ...], set[str]] = {}

    def ended(self, typed: Sequence[str]) -> None:
        """Put another line in place of the last one that was typed: the program ended at that.

        Where every line ends it there, the line before is another one.
        """
        self._left -= 1
        before = [*typed]
        self.keys = []
        if before and len(self._harmless) > 1:
            self._harmless = [line for line in self._harmless if line != before[-1]]
        while before and self._left > 0:
            *before, last = before
            tried = self._tried.setdefault((*before,), set())
            tried.add(last)
            # What has ended it elsewhere comes last.
            others = [line for line in (*self._harmless, *self._lines) if line not in tried]
            if others:
                again = itertools.chain((*before, others[0]), itertools.cycle(self._harmless))
                self.keys = [*itertools.islice(again, MOST_LINES)]
                return


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
