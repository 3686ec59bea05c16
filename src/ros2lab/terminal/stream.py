"""What comes out of a terminal, taken apart: text to show, and the signs of where a command ends."""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator
from dataclasses import dataclass

_ESCAPE = re.compile(
    "\x1b\\](?P<osc>[^\x07\x1b]*)(?:\x07|\x1b\\\\)"  # operating system command, to BEL or ST
    "|\x1b\\[(?P<parameters>[0-9;:<=>?]*)[ -/]*(?P<final>[@-~])"  # control sequence
    "|\x1b[PX^_][^\x1b]*\x1b\\\\"  # device control and other strings
    "|\x1b[ -/]*[0-Z\\\\^-~]"  # two letters
    "|\x1b"  # what begins none of these would begin one with what is left of the text
)
_UNFINISHED = re.compile("\x1b(?:\\][^\x07\x1b]*\x1b?|\\[[0-9;:<=>?]*[ -/]*|[PX^_][^\x1b]*\x1b?|[ -/]*)?$")
_LONGEST_UNFINISHED = 4096
# Jupyter shows neither; backspace, tab, line feed and carriage return it does.
_CONTROLS = re.compile("[\x00-\x07\x0b\x0c\x0e-\x1a\x1c-\x1f\x7f]")


@dataclass(frozen=True)
class Done:
    """A command has ended and bash waits for the next one.

    Attributes:
        code: its exit code.
        folder: bash's working folder, with `~` for the home folder.
    """

    code: int
    folder: str


@dataclass(frozen=True)
class Started:
    """Bash has read a whole command and runs it."""


@dataclass(frozen=True)
class Unfinished:
    """Bash has read a line and waits for the rest of the command."""


@dataclass(frozen=True)
class FullScreen:
    """A program has taken the whole screen."""


Event = Started | Done | Unfinished | FullScreen


_SIGNS: dict[str, Event] = {"133;C": Started(), "133;P": Unfinished()}


class Stream:
    """Takes the bytes of a terminal apart, in whatever pieces they come.

    Args:
        word: the end of each sign that is bash's own, and not printed by a program.
    """

    def __init__(self, word: str) -> None:
        self._word = word
        self._decoder = codecs.getincrementaldecoder("utf-8")(errors="replace")
        self._rest = ""

    def feed(self, data: bytes) -> Iterator[str | Event]:
        """Yield what is in the next bytes: texts, of which only colours are left of the escapes, and events."""
        text = self._rest + self._decoder.decode(data)
        unfinished = _UNFINISHED.search(text)
        cut = len(text)
        if unfinished and cut - unfinished.start() <= _LONGEST_UNFINISHED:
            cut = unfinished.start()
        # A carriage return may be half of a line's end.
        if text[:cut].endswith("\r"):
            cut -= 1
        text, self._rest = text[:cut], text[cut:]
        begin = 0
        for escape in _ESCAPE.finditer(text):
            event = _event(escape, self._word)
            if event is None:
                continue
            yield from _shown(text[begin : escape.start()])
            yield event
            begin = escape.end()
        yield from _shown(text[begin:])


def _event(escape: re.Match[str], word: str) -> Event | None:
    if escape["osc"] is not None:
        sign, _, own = escape["osc"].rpartition(";")
        if own != word:
            return None
        if sign in _SIGNS:
            return _SIGNS[sign]
        done = re.fullmatch(r"133;D;(\d+);(.*)", sign)
        return Done(int(done[1]), done[2]) if done else None
    if escape["final"] == "h" and escape["parameters"] in ("?1049", "?47", "?1047"):
        return FullScreen()
    return None


def _shown(text: str) -> Iterator[str]:
    """Leave colours and what moves within a line, and take out every other escape."""
    text = _ESCAPE.sub(lambda escape: escape[0] if escape["final"] == "m" else "", text)
    text = _CONTROLS.sub("", text.replace("\r\n", "\n"))
    if text:
        yield text
