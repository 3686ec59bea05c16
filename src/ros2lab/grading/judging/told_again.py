"""Which answers to commands depend only on the place in the sequence, not on the word: they are no answers.

When the commands are sent again, unknown words come before them. An answer that followed a command the first
time, but now follows one of these words and no longer the command, would have been given to any word.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping
from functools import cached_property

from ros2lab.assignments import Part
from ros2lab.grading.evidence import CommandSeen, Heard, Run
from ros2lab.grading.judging import reactions
from ros2lab.grading.judging.reactions import WARNINGS, said_by_itself, template
from ros2lab.grading.senses import seen, steady

Answer = tuple[str, str]  # the topic, empty for the log, and what it says


def told_by_place(part: Part, runs: Collection[Run], alone: Mapping[str, Heard]) -> set[str]:
    """Return the commands whose answers depend on their place and not on the word.

    Args:
        part: the part that takes the commands.
        runs: the runs in which they were sent.
        alone: by topic, what is published without commands.
    """
    first = [_Said(part, run, alone) for run in runs if not _before(part, run)]
    again = [_Said(part, run, alone) for run in runs if _before(part, run)]
    by_itself = {("", line) for run in runs for line in reactions.said_by_itself(run)}
    return {
        word
        for word in part.commands
        if (answers := set[Answer]().union(*(said.answers(word) for said in first)))
        and any(said.is_elsewhere(word, answers, by_itself) for said in again)
    }


def _before(part: Part, run: Run) -> list[CommandSeen]:
    """Return the words that were sent before the first of the part's commands."""
    return [*itertools.takewhile(lambda command: command.text not in part.commands, run.commands)]


class _Said:
    """What followed the commands in a run.

    Args:
        part: the part that takes the commands.
        run: the run in which they were sent.
        alone: by topic, what is published without commands.
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
        """The answers to the words before the first command."""
        return set[Answer]().union(*(_said(self._run, command) for command in _before(self._part, self._run)))

    def answers(self, word: str) -> set[Answer]:
        """Return what followed a command and does not follow just any word."""
        if word not in self._numbers:
            return set()
        changes = self._changed[self._numbers[word]]
        lines = {("", line) for line in self._telling[word]}
        return lines | {(topic, sense) for topic, sense in changes if topic != self._part.topic}

    def is_elsewhere(self, word: str, answers: Collection[Answer], by_itself: Collection[Answer]) -> bool:
        """Return whether some of these answers followed the words before, and none of them the command.

        If nothing follows the command, its answer may come late, with the next one. Topics that are published
        repeatedly count only if they change. Where a program has ended by then, it may be the one that would
        have answered: then what also came by itself tells nothing.
        """
        number = self._numbers.get(word)
        if number is None:
            return False
        is_alive = self._run.commands[number].is_alive
        if (self._early if is_alive else self._early.difference(by_itself)).isdisjoint(answers):
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
    """Return what followed a command, without what comes by itself."""
    lines = {("", line) for line in reactions.lines_of(run, command) - reactions.said_by_itself(run)}
    return lines | {
        (topic, sense)
        for topic, heard in command.topics.items()
        for sense in heard.senses
        if topic not in run.quiet
    }


def taken_for_unknown(part: Part, run: Run) -> dict[str, str]:
    """Return by command the last line after it that also follows every unknown word; `{}` stands for the word.

    There is a line of the command's own, too: before it, or anywhere if it is a warning. A line that follows each command
    as well is no sign of it, unless it is a warning: a node may end each answer in the same way.
    """
    first = {command.text: command for command in reversed(run.commands)}
    unknown = [command for command in run.commands if command.text and command.text in part.unknown]
    said = [{*_lines(command)} for command in unknown]
    common = set[str].intersection(*said) - said_by_itself(run) if said else set()
    if not common:
        return {}
    is_warned = all(
        level in WARNINGS
        for command in unknown
        for level, text in command.log
        if template(steady(seen(text)), command.text) in common
    )
    found = dict[str, str]()
    for word in part.commands:
        lines = _lines(first[word]) if word in first else []
        places = [number for number, line in enumerate(lines) if line in common]
        is_below = bool(places) and min(places) > 0 and places == [*range(min(places), len(lines))]
        if common < {*lines} and (is_below or is_warned):
            found[word] = lines[places[-1]]
    return found if is_warned or len(found) < len(part.commands) else {}


def _lines(command: CommandSeen) -> list[str]:
    """Return the log lines after a command that can be seen, in their order, without numbers and with `{}` instead of the command."""
    said = (template(steady(seen(text)), command.text) for _, text in command.log)
    return [*filter(None, dict.fromkeys(said))]
