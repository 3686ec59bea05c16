"""Which answers to commands come in their place only, and not of the word: they are no answers.

Where the commands are said again, words that nobody knows come before them. What followed a command at first, follows
one of these then, and does not follow the command any more, was told whatever came.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping

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
    first = [run for run in runs if not _before(part, run)]
    again = [run for run in runs if _before(part, run)]
    return {
        word
        for word in part.commands
        if (answers := set[Answer]().union(*(_answers(part, run, word, alone) for run in first)))
        and any(_is_elsewhere(part, run, word, answers, alone) for run in again)
    }


def _before(part: Part, run: Run) -> list[CommandSeen]:
    """Return what was said before any command."""
    return [*itertools.takewhile(lambda one: one.text not in part.commands, run.commands)]


def _answers(part: Part, run: Run, word: str, alone: Mapping[str, Heard]) -> set[Answer]:
    """Return what followed a command in a run, and does not follow whatever comes."""
    said = next((one for one in run.commands if one.text == word), None)
    if said is None:
        return set()
    lines = {("", line) for line in reactions.telling_lines(part, run, word)}
    return lines | {
        (topic, what) for topic, what in reactions.changed(run, said, alone) if topic != part.topic
    }


def _is_elsewhere(
    part: Part, run: Run, word: str, answers: Collection[Answer], alone: Mapping[str, Heard]
) -> bool:
    """Return whether one of some answers to a command follows other words in a run, and none of them this one.

    Where nothing follows it, what comes with the next command may be late. What comes again and again by itself says
    something after any word: it answers if it changes.
    """
    number = next((number for number, one in enumerate(run.commands) if one.text == word), None)
    if number is None:
        return False
    early = set[Answer]().union(*(_said(run, one) for one in _before(part, run)))
    then, late = (
        {answer for one in run.commands[at : at + 1] for answer in _said(run, one)}
        | {answer for one in run.commands[at : at + 1] for answer in reactions.changed(run, one, alone)}
        for at in (number, number + 1)
    )
    then = then or late
    return not early.isdisjoint(answers) and then.isdisjoint(answers)


def _said(run: Run, one: CommandSeen) -> set[Answer]:
    """Return what came after a command, of what does not come by itself."""
    lines = {("", line) for line in reactions.lines_of(run, one) - reactions.said_by_itself(run)}
    return lines | {
        (topic, reactions.sense([value]))
        for topic, heard in one.topics.items()
        for value in heard.values
        if topic not in run.quiet
    }
