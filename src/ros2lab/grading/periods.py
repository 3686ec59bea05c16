"""How often the messages of a node came, as it was seen in a run."""

from __future__ import annotations

import statistics

from ros2lab.grading.player import Player
from ros2lab.rhythm import gaps_apart


def period_of(player: Player) -> float | None:
    """Return the time between two messages, in s, before any command if it is seen there; None if it is not seen."""
    gaps = gaps_apart(quiet_times(player)) or gaps_of(player)
    return statistics.median(gaps) if gaps else None


def quiet_times(player: Player) -> list[float]:
    """Return when messages came before any command, in s."""
    quiet = player.run.quiet.get(player.topic)
    return quiet.times if quiet else []


def gaps_of(player: Player) -> list[float]:
    """Return the times between all messages that came in a run, in s."""
    return gaps_apart([time for heard in player.heard for time in heard.times])
