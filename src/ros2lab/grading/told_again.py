"""Which answers to commands come in their place only, and not of the word: they are no answers.

Where the commands are said again, words that nobody knows come before them. What followed a command at first, follows
one of these then, and does not follow the command any more, was told whatever came.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Mapping

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
        and any(_is_elsewhere(part, run, word, answers) for run in again)
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


def _is_elsewhere(part: Part, run: Run, word: str, answers: Collection[Answer]) -> bool:
    """Return whether one of some answers to a command follows other words in a run, and none of them this one.

    Where nothing follows it, what comes with the next command may be late. A topic on which something comes again and
    again must have said something else.
    """
    number = next((number for number, one in enumerate(run.commands) if one.text == word), None)
    if number is None:
        return False
    then = _said(run.commands[number : number + 1])
    if all(place in run.quiet or what in reactions.said_by_itself(run) for place, what in then):
        then |= _said(run.commands[number + 1 : number + 2])
    places = {place for place, _ in then} | ({place for place, _ in answers} - run.quiet.keys())
    early = {answer for answer in _said(_before(part, run)) if answer[0] in places}
    return not early.isdisjoint(answers) and then.isdisjoint(answers)


def _said(commands: Iterable[CommandSeen]) -> set[Answer]:
    """Return what came after some commands."""
    return {
        answer
        for one in commands
        for answer in (
            *(("", line) for line in reactions.lines_of(one)),
            *(
                (topic, reactions.sense([value]))
                for topic, heard in one.topics.items()
                for value in heard.values
            ),
        )
    }
