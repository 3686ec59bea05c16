"""Words that nobody knows, drawn so near to the commands that nothing of their shape tells them from these.

A node that knows its commands by a length, by letters at some places, or by which letters there are, takes some of
these words for commands. One that compares whole words does not, nor does one that overlooks a slip of the finger.
"""

from __future__ import annotations

import string
from collections.abc import Collection, Iterator, Sequence
from difflib import get_close_matches
from itertools import combinations, cycle
from random import Random

MOST_DRAWN = 2000  # words, of which many are too near; of a command of one letter all may be
POOL = 70  # words from which the best are taken

Shared = tuple[str, ...]  # a command, and one or two traits that a word has in common with it


def near_words(commands: Sequence[str], known: Collection[str], seed: str) -> Iterator[str]:
    """Yield words, each as long as a command, which together have as much in common with each command as few words can.

    Args:
        commands: that are known.
        known: texts that may mean something, which are not among the words.
        seed: of the same seed come the same words.
    """
    taken = {text.lower() for text in (*commands, *known)}
    left = {
        word: (_shared(word, commands, 1), _shared(word, commands, 2))
        for word in _drawn(Random(seed), commands, taken)  # noqa: S311 -- unpredictable is what the seed is
    }
    covered = set[Shared]()
    while left:
        word = max(left, key=lambda word: [len(traits - covered) for traits in left[word]])
        covered = covered.union(*left.pop(word))
        yield word


def _drawn(draw: Random, commands: Sequence[str], taken: Collection[str]) -> list[str]:
    """Return words of the letters of the commands that are neither taken nor meant as one of these."""
    letters = sorted({letter for command in commands for letter in command if letter.isalnum()})
    words = dict[str, None]()
    for number, like in zip(range(MOST_DRAWN), cycle(commands), strict=False):
        if number == MOST_DRAWN // 2:  # of too few letters there are no words
            letters = [*string.ascii_lowercase]
        word = _word(draw, like, commands, letters)
        if word.lower() not in {*taken, *map(str.lower, words)} and not _is_meant(word, commands):
            words[word] = None
        if len(words) == POOL:
            break
    return [*words]


def _word(draw: Random, like: str, commands: Sequence[str], letters: Sequence[str]) -> str:
    """Return a word of the form of a command: at each place any letter, or that of some command, from either end."""
    word = list[str]()
    for place, letter in enumerate(like):
        other = draw.choice(commands)
        there = draw.choice((other[place : place + 1], other[max(0, place - len(like) + len(other)) :][:1]))
        is_taken = there.isalnum() and draw.random() < 0.8
        word.append(there if is_taken else draw.choice(letters) if letter.isalnum() else letter)
    return "".join(word)


def _shared(word: str, commands: Sequence[str], count: int) -> set[Shared]:
    """Return each so many traits at once that a word has in common with a command."""
    return {
        (command, *traits)
        for command in commands
        for traits in combinations(sorted(_traits(word) & _traits(command)), count)
    }


def _traits(word: str) -> set[str]:
    """Return what a program may look at that does not compare whole words."""
    at = {f"{place} {letter}" for place, letter in enumerate(word)}
    return at | {f"last {word[-1:]}", f"length {len(word)}", f"letters {sorted({*word})}"}


def _is_meant(word: str, commands: Sequence[str]) -> bool:
    """Return whether a command stands in a word, or a tolerant reader takes it for one."""
    return any(command in word or word in command for command in commands) or bool(
        get_close_matches(word, commands)
    )
