"""Commands after which a node also does what it does for unknown words, as after `if`, `if`, `if`, `else`."""

from __future__ import annotations

from ros2lab.assignments import Part
from ros2lab.grading.evidence import CommandSeen, Run
from ros2lab.grading.judging.reactions import WARNINGS, said_by_itself, template
from ros2lab.grading.senses import seen, steady


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
