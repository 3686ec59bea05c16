"""Which answers to commands come in their place only, and not of the word: they are no answers.

Where the commands are said again, words that nobody knows come before them. What followed a command at first, follows
one of these then, and does not follow the command any more, was told whatever came.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping
from functools import cached_property

from ros2lab.assignments import Part
from ros2lab.grading import reactions
from ros2lab.grading.evidence import CommandSeen, Heard, Run

Answer = tuple[str, str]  # the topic on which it came, empty for the log, and what it says


def told_by_place(part: Part, runs: Collection[Run], alone: Mapping[str, Heard]) -> set[str]:
    """Return the commands whose answers come in their place and not of the word.

    Args:
        part: that takes the commands.
        runs: in which they were said.
        alone: what comes on each topic by itself.
    """
    first = [_Said(part, run, alone) for run in runs if not _before(part, run)]
    again = [_Said(part, run, alone) for run in runs if _before(part, run)]
    return {
        word
        for word in part.commands
        if (answers := set[Answer]().union(*(said.answers(word) for said in first)))
        and any(said.is_elsewhere(word, answers) for said in again)
    }


def _before(part: Part, run: Run) -> list[CommandSeen]:
    """Return what was said before any command."""
    return [*itertools.takewhile(lambda command: command.text not in part.commands, run.commands)]


class _Said:
    """What followed the commands in a run.

    Args:
        part: that takes the commands.
        run: in which they were said.
        alone: what comes on each topic by itself.
    """

    def __init__(self, part: Part, run: Run, alone: Mapping[str, Heard]) -> None:
        self._part = part
        self._run = run
        self._changed = reactions.changed(run, alone)
        self._numbers = {command.text: number for number, command in reversed([*enumerate(run.commands)])}

    @cached_property
    def _telling(self) -> dict[str, set[str]]:
        return reactions.telling_lines(self._part, self._run)

    @cached_property
    def _early(self) -> set[Answer]:
        """What followed what was said before any command."""
        return set[Answer]().union(*(_said(self._run, command) for command in _before(self._part, self._run)))

    def answers(self, word: str) -> set[Answer]:
        """Return what followed a command, and does not follow whatever comes."""
        if word not in self._numbers:
            return set()
        changes = self._changed[self._numbers[word]]
        lines = {("", line) for line in self._telling[word]}
        return lines | {(topic, sense) for topic, sense in changes if topic != self._part.topic}

    def is_elsewhere(self, word: str, answers: Collection[Answer]) -> bool:
        """Return whether one of some answers to a command follows other words, and none of them this one.

        Where nothing follows it, what comes with the next command may be late. What comes again and again by itself
        says something after any word: it answers if it changes.
        """
        number = self._numbers.get(word)
        if number is None or self._early.isdisjoint(answers):
            return False
        return (self._after(number) or self._after(number + 1)).isdisjoint(answers)

    def _after(self, number: int) -> set[Answer]:
        return {
            answer
            for command, changes in zip(
                self._run.commands[number : number + 1], self._changed[number : number + 1], strict=True
            )
            for answer in (*_said(self._run, command), *changes)
        }


def _said(run: Run, command: CommandSeen) -> set[Answer]:
    """Return what came after a command, of what does not come by itself."""
    lines = {("", line) for line in reactions.lines_of(run, command) - reactions.said_by_itself(run)}
    return lines | {
        (topic, sense)
        for topic, heard in command.topics.items()
        for sense in heard.senses
        if topic not in run.quiet
    }
