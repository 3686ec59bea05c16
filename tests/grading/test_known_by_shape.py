"""A node that knows commands by a trait of theirs obeys unknown words, too, and so knows none of these commands."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from difflib import get_close_matches
from statistics import mean

import evidences
import pytest

from ros2lab import assignments
from ros2lab.grading.evidence import CommandSeen, Run
from ros2lab.grading.judging.reactions import effects_of
from ros2lab.grading.questions.commands import _logged
from ros2lab.grading.watching.script import Script

LINES = {"start": "The robot moves", "stop": "The robot halts", "reset": "Back at zero"}
WARNING = "This is no command"
SEEDS = [f"hand-in {number}" for number in range(12)]

Node = Callable[[str], list[str]]


def known(node: Node, seed: str) -> tuple[int, int]:
    """Return how many commands are processed, and how many the log tells of."""
    part = assignments.load().with_coined_words(seed).commanded
    assert part is not None
    said = [
        CommandSeen(
            word, [("WARN" if line == WARNING else "INFO", line) for line in node(word)], {}, {}, True
        )
        for word in Script(part).all
    ]
    run = Run(
        ["command_subscriber"], "alone", "stepped", ["/command_subscriber"], {},
        {part.topic: {"/command_subscriber": [evidences.STRING]}}, {}, {}, {}, said, {}, {}, [],
        commanded=part.topic,
    )  # fmt: skip
    effects = effects_of(part, run, {}, has_own_log=True)
    return [*effects.values()].count("processed"), len(_logged(part, run))


def by(trait: Callable[[str], Hashable], other: str = WARNING) -> Node:
    """Return a node that takes for a command what has a trait in common with it."""

    def told(word: str) -> list[str]:
        lines = [line for command, line in LINES.items() if trait(word) == trait(command)]
        return lines[:1] or [*filter(None, [other])]

    return told


@pytest.mark.parametrize(
    "node",
    [
        by(lambda word: word[:1]),
        by(lambda word: word[2:3]),
        by(lambda word: word[2:3].lower(), ""),
        by(lambda word: word[-1:]),
        by(lambda word: (len(word), word[:1])),
        lambda word: [LINES["start"] if "a" in word else LINES["stop"] if "o" in word else LINES["reset"]],
    ],
    ids=["first", "third", "third, silent else", "last", "length and first", "a letter in it"],
)
def test_a_trait_is_no_command(node: Node) -> None:
    processed, logged = zip(*(known(node, seed) for seed in SEEDS), strict=True)
    assert mean(processed) < 1.5
    assert mean(logged) < 1.5


@pytest.mark.parametrize(
    "node",
    [
        by(str),
        by(str.lower),
        by(str, ""),
        lambda word: [LINES[near[0]] if (near := get_close_matches(word, LINES)) else WARNING],
        lambda word: [f"Received {word}", *([] if word in LINES else [WARNING])],
        lambda word: ["Done" if word in LINES else WARNING],
    ],
    ids=["whole word", "any case", "silent else", "slip of the finger", "repeats it", "one line for all"],
)
def test_a_word_is_a_command_however_it_is_answered(node: Node) -> None:
    assert {known(node, seed) for seed in SEEDS} == {(3, 3)}
