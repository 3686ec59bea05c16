"""In which way of starting the nodes an assignment is done: all of it has to be seen in one.

The programs themselves are one way, each launch file is another. What a launch file does not start may be started
beside it, by itself or by a launch file that starts nothing of the same; nobody starts a node twice.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ros2lab.grading.periods import period_of
from ros2lab.grading.player import MATCHES, Player
from ros2lab.rhythm import has_period

Way = dict[str, list[Player]]  # by part, who plays it in this way; the most telling first


def best_way(players: Mapping[str, Sequence[Player]]) -> Way:
    """Return the way in which most topics are right; of equals, the one with most of the periods.

    Args:
        players: by part, who plays it; in each run in which it was seen, the most telling first.
    """
    launched = {
        player.number for found in players.values() for player in found if player.run.setting == "launched"
    }
    of_programs = _only(players, {player.number for found in players.values() for player in found} - launched)
    ways = [of_programs, *(_only(players, {number}) for number in sorted(launched))]
    return max((_completed(way, ways) for way in ways), key=_worth)


def _only(players: Mapping[str, Sequence[Player]], numbers: set[int]) -> Way:
    """Return who plays which part in some of the runs."""
    found = {name: [one for one in everybody if one.number in numbers] for name, everybody in players.items()}
    return {name: some for name, some in found.items() if some}


def _completed(way: Way, others: Iterable[Way]) -> Way:
    """Return a way with what can be started beside it."""
    whole = dict(way)
    for other in sorted(others, key=lambda other: (_is_launched(other), _worth(other)), reverse=True):
        if _is_launched(other) and not other.keys().isdisjoint(whole):
            continue  # it can only be started as a whole
        started = {
            _base(node)
            for player in _all(whole)
            if player.run.setting == "launched"
            for node in player.run.nodes
        }
        whole |= {
            name: players
            for name, players in other.items()
            if name not in whole and started.isdisjoint(_base(player.node) for player in players)
        }
    return whole


def _is_launched(way: Way) -> bool:
    return any(player.run.setting == "launched" for player in _all(way))


def _all(way: Way) -> list[Player]:
    return [player for players in way.values() for player in players]


def _base(node: str) -> str:
    """Return the name of a node without its namespace."""
    return node.rpartition("/")[2]


def _worth(way: Way) -> tuple[int, int, int]:
    """Return how many topics and periods are right in a way, and how near the other topics are."""
    best = [min(MATCHES.index(player.match) for player in players) for players in way.values()]
    return best.count(0), sum(map(_has_period, way.values())), sum(len(MATCHES) - one for one in best)


def _has_period(players: Sequence[Player]) -> bool:
    periods = [(player.part.period, period_of(player)) for player in players]
    return any(asked and period is not None and has_period(period, asked) for asked, period in periods)
