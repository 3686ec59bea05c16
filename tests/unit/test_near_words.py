"""Words that nobody knows are as near to the commands as no property of shape can tell, and never mean one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from difflib import get_close_matches
from itertools import islice

import pytest

from ros2lab import assignments
from ros2lab.assignments.near_words import near_words

COMMANDS = ("start", "stop", "reset")
SEEDS = [f"hand-in {number}" for number in range(20)]


def drawn(seed: str, commands: Sequence[str] = COMMANDS, known: Sequence[str] = ()) -> list[str]:
    return [*islice(near_words(commands, known, seed), 3)]


def test_each_is_as_long_as_a_command_and_made_of_their_letters() -> None:
    words = [word for seed in SEEDS for word in drawn(seed)]
    assert {*map(len, words)} == {4, 5}
    assert {*"".join(words)} <= {*"".join(COMMANDS)}


# What a program may look at that does not compare whole words.
TRAITS: dict[str, Callable[[str], str]] = {
    "first": lambda word: word[0],
    "second": lambda word: word[1],
    "third": lambda word: word[2],
    "last": lambda word: word[-1],
    "length": lambda word: str(len(word)),
}


@pytest.mark.parametrize("name", TRAITS)
def test_three_have_nearly_every_trait_of_each_command(name: str) -> None:
    trait = TRAITS[name]
    lacking = [{*map(trait, COMMANDS)} - {*map(trait, drawn(seed))} for seed in SEEDS]
    assert sum(map(len, lacking)) <= len(SEEDS) / 2


# How honest programs know a command, some of them more tolerantly than they need to.
READERS: dict[str, Callable[[str], bool]] = {
    "as it is": lambda word: word in COMMANDS,
    "in any case": lambda word: word.strip().lower() in COMMANDS,
    "within a text": lambda word: any(command in word for command in COMMANDS),
    "by its beginning": lambda word: word.startswith(COMMANDS),
    "with a slip of the finger": lambda word: bool(get_close_matches(word, COMMANDS)),
    "as words of a text": lambda word: not {*word.split()}.isdisjoint(COMMANDS),
}


@pytest.mark.parametrize("name", READERS)
def test_what_reads_commands_takes_none_for_one(name: str) -> None:
    assert not any(READERS[name](word) for seed in SEEDS for word in drawn(seed))
    assert all(map(READERS[name], COMMANDS))


def test_they_differ_from_hand_in_to_hand_in() -> None:
    assert drawn("one") == drawn("one")
    assert len({*map(tuple, map(drawn, SEEDS))}) == len(SEEDS)


def test_what_may_mean_something_is_not_drawn() -> None:
    """Such as a word of the hand-in's own that was drawn."""
    first, *_ = drawn("one")
    assert first not in drawn("one", known=[first.upper()])


@pytest.mark.parametrize(
    "commands", [("go",), ("g", "s"), ("1", "2"), ("GO LEFT", "go right"), ("on", "off")]
)
def test_there_are_some_near_any_commands(commands: tuple[str, ...]) -> None:
    words = drawn("one", commands)
    assert len({*words}) == 3
    assert {*map(len, words)} <= {*map(len, commands)}
    assert all(word == word.strip() for word in words)


def test_they_come_before_the_unknown_texts_of_an_assignment() -> None:
    course = assignments.load()
    assert course.commanded is not None
    coined = course.with_coined_words("one").commanded
    assert coined is not None
    assert coined.unknown[-len(course.commanded.unknown) :] == course.commanded.unknown
    assert len(coined.unknown) == len(course.commanded.unknown) + len(course.commanded.commands)
    assert {*coined.unknown}.isdisjoint(coined.before)
