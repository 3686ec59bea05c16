"""What comes out of a terminal is taken apart, in whatever pieces it comes."""

from __future__ import annotations

import pytest

from ros2lab.terminal.stream import Done, Stream

WORD = "secret"


@pytest.mark.parametrize(
    ("written", "shown"),
    [
        ("\x1b[31mred\x1b[0m\n", "\x1b[31mred\x1b[0m\n"),
        ("a\x1b[2Jb\x1b]0;title\x07c\x1b]52;c;ZXZpbA==\x1b\\d", "abcd"),
        ("\x1b\x1b[2J[2Jwhat is left begins nothing", "[2Jwhat is left begins nothing"),
        ("\x1b\x1b]0;x\x07]52;c;ZXZpbA==\x07", "]52;c;ZXZpbA=="),
        ("\x1b[\x1b[2J2Jnor inside", "[2Jnor inside"),
        (f"\x1b]{'never ended ' * 500}\n", f"]{'never ended ' * 500}\n"),
    ],
)
def test_only_colours_are_left(written: str, shown: str) -> None:
    for size in (1, 7, len(written)):
        stream = Stream(WORD)
        pieces = [written[at : at + size] for at in range(0, len(written), size)]
        said = [event for piece in pieces for event in stream.feed(piece.encode())]
        assert "".join(map(str, said)) == shown


def test_an_end_is_believed_only_with_the_word_of_bash() -> None:
    written = f"\x1b]133;D;0;~;guessed\x07a\x1b]133;D;3;~;{WORD}\x07"
    assert [*Stream(WORD).feed(written.encode())] == ["a", Done(3, "~")]
