"""How often the messages of a node came in the runs, and whether that follows a parameter."""

from __future__ import annotations

import itertools
import math
import statistics
from collections.abc import Sequence
from typing import TypeGuard

from ros2lab.assignments import Part
from ros2lab.grading.evidence import Run
from ros2lab.grading.judging.player import Player
from ros2lab.rhythm import AT_A_TIME, between, gaps_apart, is_another

NEARLY = 1.2  # the factor within which two periods count as the same, or a change as following a parameter


def period_of(player: Player) -> float | None:
    """Return the median time between two messages, in s; before any command, if messages came then.

    None if there are no two messages, or the program ran with changed parameters.
    """
    if player.program in player.run.changed:
        return None
    if gaps := gaps_apart(quiet_times(player)):
        return statistics.median(gaps)
    gaps = gaps_of(player)
    # Each step of a stepped clock delays what a timer brings, and the next one makes up for it.
    middle = statistics.fmean if player.run.clock == "stepped" else statistics.median
    return middle(gaps) if gaps else None


def quiet_times(player: Player) -> list[float]:
    """Return the times of the messages before any command, in s."""
    quiet = player.run.quiet.get(player.topic)
    return quiet.times if quiet else []


def gaps_of(player: Player) -> list[float]:
    """Return the times between the messages of a whole run, in s.

    Empty if no two came apart from each other after the same command: then the rhythm is that of the commands. On a
    stepped clock, time passes after each of these: what is silent then has paused. On the real one they may come
    quickly, and a message before them tells of a rhythm, too. What came while something was given has the rhythm of that.
    """
    run, is_stepped = player.run, player.run.clock == "stepped"
    stretches = [
        topics[player.topic].times if player.topic in topics else []
        for topics in (run.stretches if player.heard else ())
        if topics is not run.meanwhile
    ]
    # On the real clock, commands may follow each other more quickly than messages.
    blocks = itertools.groupby(stretches, lambda times: bool(times) and is_stepped)
    gaps = [gap for _, block in blocks for gap in between([*itertools.chain.from_iterable(block)])]
    least = AT_A_TIME * max(gaps, default=0.0)
    is_own = any(gap > least for times in stretches for gap in between(times))
    return [gap for gap in gaps if gap > least] if is_own or (quiet_times(player) and not is_stepped) else []


def is_changed(before: Run, after: Run) -> bool:
    """Return whether the period of any topic changed by more than chance."""
    return any(is_another(new, old) for old, new in _pairs(before, after).values())


def is_followed(before: Run, tries: Sequence[Run], declared: object = None) -> bool | None:
    """Return whether the period or rate of a topic changes with the values of a parameter.

    A limit in the code may make it follow less far; it must not go the other way, nor further.

    Args:
        before: the program with its own value.
        tries: the same program with other values.
        declared: its own value in the code, for a program that does not report it.

    Returns:
        None if its own value is not known to be a number.
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
        # The nodes of a program may have different values for the same name.
        own = {numbers[node] for node in nodes if node in numbers} or {*numbers.values()}
        periods = [(value, *pairs[topic]) for value, pairs in seen if topic in pairs]
        if any(_follows(periods, number, sign) for number in own for sign in (1, -1)):
            return True
    return False


def _follows(periods: Sequence[tuple[float, float, float]], own: float, sign: int) -> bool:
    """Return whether a period (sign 1) or a rate (sign -1) follows a parameter.

    Args:
        periods: triples of a parameter value, the period before, and the period with this value.
        own: the program's own value.
        sign: period or rate.
    """
    nearly = math.log(NEARLY)
    changes = [(sign * math.log(abs(value / own)), math.log(new / old)) for value, old, new in periods]
    return any(asked and abs(seen - asked) < nearly for asked, seen in changes) and all(
        min(0.0, asked) - nearly < seen < max(0.0, asked) + nearly for asked, seen in changes
    )


def _pairs(before: Run, after: Run) -> dict[str, tuple[float, float]]:
    """Return by topic its periods in two runs, for topics that have one in both.

    A loop in a thread of its own may be late on a busy machine and catch up: its gaps are then twice as long,
    but as many messages come. That counts as the same period.
    """
    found = {}
    for topic in before.publishes:
        players = [_publisher(topic, run) for run in (before, after)]
        old, new = map(period_of, players)
        if old and new:
            found[topic] = (old, old if _come_as_many(*players) else new)
    return found


def _come_as_many(before: Player, after: Player) -> bool:
    """Return whether messages come at the same mean rate in two runs, before any command."""
    spans = [(len(times) - 1, times[-1] - times[0]) for times in map(quiet_times, (before, after)) if times]
    means = [span / gaps for gaps, span in spans if gaps and span]
    return len(means) == len((before, after)) and max(means) / min(means) < NEARLY


def has_rhythm(run: Run) -> bool:
    """Return whether any topic is published repeatedly."""
    return any(period_of(_publisher(topic, run)) for topic in run.publishes)


def _publisher(topic: str, run: Run) -> Player:
    return Player(Part("", "publisher", topic, ""), "right", topic, "", (), 0, run, "")


def _given(run: Run) -> float:
    """Return the number that a run's parameter was set to; 0 if there is none."""
    text = run.setting.partition(":=")[2]
    try:
        return float(text)
    except ValueError:
        return 0.0


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and value != 0
