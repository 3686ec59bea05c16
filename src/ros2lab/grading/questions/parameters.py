"""Questions about an assignment's parameters: whether another value changes a topic's rhythm or messages."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from ros2lab.assignments import AskedParameter, Part
from ros2lab.grading.evidence import Run
from ros2lab.grading.judging.periods import period_of
from ros2lab.grading.judging.player import Player
from ros2lab.grading.judging.players import Case
from ros2lab.grading.questions import nodes
from ros2lab.grading.questions.answer import Answer, ended, listed, question, shown
from ros2lab.rhythm import is_another


@question(
    "all some none missing",
    "without topic",
    nodes.CODES | frozenset(("parameter-undeclared", "parameter-type")),
    ("publisher",),
    needs="parameters",
)
def parameters_take_effect(case: Case, part: Part) -> Answer:
    """Whether another value of each parameter changes the topic as the assignment says."""
    players = [player for player in case.players[part.name] if player.run.setting == "alone"]
    pairs = [
        (parameter, number, _fault(case, parameter, players, run))
        for parameter in part.parameters
        for number, run in enumerate(case.evidence.runs)
        if _is_try(parameter, run, players)
    ]
    undeclared = [
        f"{parameter.name}, which no such node declares"
        for parameter in part.parameters
        if all(parameter is not tried for tried, *_ in pairs)
    ]
    # If several programs have such a parameter, one that works is enough.
    right = {parameter.name for parameter, _, fault in pairs if not fault}
    wrong = dict.fromkeys(fault for parameter, _, fault in pairs if parameter.name not in right)
    without = [*wrong, *undeclared]
    topic = shown(players[0].topic if players else part.topic)
    keys = tuple(f"runs[{number}].setting" for _, number, _ in pairs) or ("runs",)
    level = "missing" if not pairs else "all" if not without else "some" if right else "none"
    if level == "missing":
        without = [parameter.name for parameter in part.parameters]
    return Answer(level, {"without": listed(without), "topic": topic}, keys, topic)


def setting(name: str, value: Any, held: Sequence[Any] = ()) -> str:
    """Return the argument that sets a parameter at a program's start.

    Args:
        name: the parameter's name.
        value: its new value.
        held: its own value, if known: if that is a float, a whole number is written as a float, too.
    """
    if held and isinstance(held[0], float) and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    return f"{name}:={json.dumps(value)}"


def _is_try(parameter: AskedParameter, run: Run, players: Sequence[Player]) -> bool:
    """Return whether a run is of a player's program with the value that the assignment asks for."""
    given = {setting(parameter.name, parameter.value), setting(parameter.name, parameter.value, [0.0])}
    return run.setting in given and any(player.run.programs == run.programs for player in players)


def _fault(case: Case, parameter: AskedParameter, players: Sequence[Player], run: Run) -> str:
    """Return what is wrong with a parameter's effect in a run; empty if nothing is."""
    before = next(player for player in players if player.run.programs == run.programs)
    tried = shown(run.setting)
    if run.ended:
        return f"{tried}, with which it ended {ended(' '.join(run.ended.values()), 'by')}"
    held = [values[parameter.name] for values in before.run.parameters.values() if parameter.name in values]
    unchanged = {setting(parameter.name, value) for value in held}
    if run.setting in unchanged:
        return f"{tried}, which is what it has by itself"
    after = replace(before, run=run)
    if parameter.changes == "rhythm":
        return "" if _changes_rhythm(before, after) else tried
    again = [
        replace(before, run=repeated)
        for repeated in case.evidence.runs
        if repeated.setting in unchanged and repeated.programs == run.programs
    ]
    return "" if _changes_messages(after, [before, *again]) else tried


def _changes_rhythm(before: Player, after: Player) -> bool:
    old, new = period_of(before), period_of(after)
    return old is not None and new is not None and is_another(old, new)


def _changes_messages(after: Player, unchanged: Sequence[Player]) -> bool:
    """Return whether a field has a new value in a message where it was the same in all runs before."""
    changed = _fields(after)
    before = [_fields(player) for player in unchanged]
    count = min(map(len, (changed, *before)))
    if after.run.clock == "real":  # which message comes first is chance there
        count = (count + 1) // 2
    for number, fields in enumerate(changed[:count]):
        for name, value in fields.items():
            then = {messages[number].get(name, "") for messages in before}
            ever = {message.get(name, "") for messages in before for message in messages}
            if len(then) == 1 and value not in ever:
                return True
    return False


def _fields(player: Player) -> list[dict[str, str]]:
    """Return the messages before any command, each by its innermost fields with their values as JSON."""
    quiet = player.run.quiet.get(player.topic)
    return [dict(_innermost("", value)) for value in quiet.values] if quiet else []


def _innermost(name: str, value: Any) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _innermost(f"{name}.{key}", inner)
    else:
        yield name, json.dumps(value)
