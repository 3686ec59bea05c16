"""Words that nobody knows, drawn so near to the commands that nothing of their shape tells them from these.

A node that knows its commands by a length, a letter, a beginning or an ending takes some of these words for commands.
One that compares whole words does not, nor does one that overlooks a slip of the finger.
"""

from __future__ import annotations

import string
from collections.abc import Collection, Iterator, Sequence
from difflib import get_close_matches
from itertools import cycle
from random import Random

MOST_DRAWN = 2000  # words, of which few are too near; of a command of one letter all may be
LONGEST_END = 2  # letters


def near_words(commands: Sequence[str], known: Collection[str], seed: str) -> Iterator[str]:
    """Yield words, each as long as a command, and made of the letters, beginnings and endings of the commands.

    Args:
        commands: that are known, in whose turn the words come.
        known: texts that may mean something, which are not among the words.
        seed: of the same seed come the same words.
    """
    draw = Random(seed)  # noqa: S311 -- unpredictable is what the seed is
    letters = sorted({letter for command in commands for letter in command if letter.isalnum()})
    taken = {text.lower() for text in (*commands, *known)}
    for number, like in zip(range(MOST_DRAWN), cycle(commands), strict=False):
        if number == MOST_DRAWN // 2:  # of too few letters there are no words
            letters = [*string.ascii_lowercase]
        word = _word(draw, like, commands, letters)
        if word.lower() in taken or _is_meant(word, commands):
            continue
        taken.add(word.lower())
        yield word


def _word(draw: Random, like: str, commands: Sequence[str], letters: Sequence[str]) -> str:
    """Return a word of the form of a command, with the beginning and the end of some."""
    word = [draw.choice(letters) if letter.isalnum() else letter for letter in like]
    first, last = (min(draw.randint(1, LONGEST_END), (len(like) - 1) // 2) for _ in range(2))
    word[:first] = draw.choice(commands)[:first].ljust(first, letters[0])
    word[len(word) - last :] = draw.choice(commands)[-last:].rjust(last, letters[0]) if last else ""
    return "".join(word)


def _is_meant(word: str, commands: Sequence[str]) -> bool:
    """Return whether a command stands in a word, or a tolerant reader takes it for one."""
    return any(command in word or word in command for command in commands) or bool(
        get_close_matches(word, commands)
    )
