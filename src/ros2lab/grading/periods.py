"""How often the messages of a node came, as it was seen in runs, and whether that follows a parameter."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from typing import TypeGuard

from ros2lab.assignments import Part
from ros2lab.grading.evidence import Run
from ros2lab.grading.player import Player
from ros2lab.rhythm import gaps_apart, is_another

NEARLY = 1.2  # times, by which what follows a parameter may differ from it, and what is the same from itself


def period_of(player: Player) -> float | None:
    """Return the time between two messages, in s, before any command if it is seen there.

    None if it is not seen, or the program had other parameters than by itself.
    """
    if player.program in player.run.changed:
        return None
    gaps = gaps_apart(quiet_times(player)) or gaps_of(player)
    return statistics.median(gaps) if gaps else None


def quiet_times(player: Player) -> list[float]:
    """Return when messages came before any command, in s."""
    quiet = player.run.quiet.get(player.topic)
    return quiet.times if quiet else []


def gaps_of(player: Player) -> list[float]:
    """Return the times between all messages that came in a run, in s.

    What never comes but once behind a command has the rhythm of the commands, and none of its own.
    """
    is_own = quiet_times(player) or any(heard.count > 1 for heard in player.heard)
    return gaps_apart([time for heard in player.heard for time in heard.times]) if is_own else []


def is_changed(before: Run, after: Run) -> bool:
    """Return whether any topic comes in another rhythm, by more than chance."""
    return any(is_another(new, old) for old, new in _pairs(before, after).values())


def is_followed(before: Run, tries: Sequence[Run], declared: object = None) -> bool | None:
    """Return whether a topic's period, or its rate, changes as the values of a parameter do.

    One that keeps to a limit follows some values less far; it does not go the other way, nor further.

    Args:
        before: a program with the value that it has by itself.
        tries: the same with other values.
        declared: what it has by itself as the code says, for where it does not tell.

    Returns:
        None if no number is known that it had before.
    """
    name = tries[0].setting.partition(":=")[0]
    told = {node: values.get(name) for node, values in before.parameters.items()}
    numbers = {node: value for node, value in told.items() if _is_number(value)}
    if not numbers and _is_number(declared):
        numbers = {"": declared}
    if not numbers:
        return None
    seen = [(value, _pairs(before, run)) for run in tries if (value := _given(run))]
    for topic, nodes in before.publishes.items():
        # Nodes of one program may have other values of one name.
        own = {numbers[node] for node in nodes if node in numbers} or {*numbers.values()}
        periods = [(value, *pairs[topic]) for value, pairs in seen if topic in pairs]
        if any(_follows(periods, number, sign) for number in own for sign in (1, -1)):
            return True
    return False


def _follows(periods: Sequence[tuple[float, float, float]], own: float, sign: int) -> bool:
    """Return whether a period (sign 1) or a rate (sign -1) follows a parameter.

    Args:
        periods: a value of the parameter, the period before, and the period with it.
        own: the value before.
        sign: which of the two is asked for.
    """
    nearly = math.log(NEARLY)
    changes = [(sign * math.log(abs(value / own)), math.log(new / old)) for value, old, new in periods]
    return any(asked and abs(seen - asked) < nearly for asked, seen in changes) and all(
        min(0.0, asked) - nearly < seen < max(0.0, asked) + nearly for asked, seen in changes
    )


def _pairs(before: Run, after: Run) -> dict[str, tuple[float, float]]:
    """Return the period of each topic in two runs, where it has one in both.

    A loop that waits in a thread of its own is late where the machine is busy, and makes up for it: its gaps are then
    twice as long, but as many messages come. That is no other period.
    """
    found = {}
    for topic in before.publishes:
        players = [_publisher(topic, run) for run in (before, after)]
        old, new = map(period_of, players)
        if old and new:
            found[topic] = (old, old if _come_as_many(*players) else new)
    return found


def _come_as_many(before: Player, after: Player) -> bool:
    """Return whether in two runs as many messages come in the same time, before any command."""
    spans = [(len(times) - 1, times[-1] - times[0]) for times in map(quiet_times, (before, after)) if times]
    means = [span / gaps for gaps, span in spans if gaps and span]
    return len(means) == len((before, after)) and max(means) / min(means) < NEARLY


def has_rhythm(run: Run) -> bool:
    """Return whether any topic comes again and again."""
    return any(period_of(_publisher(topic, run)) for topic in run.publishes)


def _publisher(topic: str, run: Run) -> Player:
    return Player(Part("", "publisher", topic, ""), "right", topic, "", (), 0, run, "")


def _given(run: Run) -> float:
    """Return the number that a parameter was given in a run; 0 if it was given none."""
    text = run.setting.partition(":=")[2]
    try:
        return float(text)
    except ValueError:
        return 0.0


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and value != 0
