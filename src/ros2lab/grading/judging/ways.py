"""The ways of starting the nodes: all of an assignment must work in one of them.

Starting the programs one by one is one way, each launch file is another. What a launch file does not start
may be started beside it, by itself or by a launch file without the same nodes; no node is started twice. A
program that does not run beside the others is a way of its own.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

from ros2lab.grading.evidence import Run
from ros2lab.grading.judging.periods import period_of
from ros2lab.grading.judging.player import MATCHES, Player
from ros2lab.rhythm import has_period

Way = dict[str, list[Player]]  # by part, its players in this way; the most telling first


def best_way(players: Mapping[str, Sequence[Player]], shut_out: Collection[str] = ()) -> Way:
    """Return the way in which most topics are right; of equal ones, that in which most comes, with the right periods.

    Args:
        players: by part, its players in each run, the most telling first.
        shut_out: the programs that do not run beside the others; see below.
    """
    numbers: dict[str, set[int]] = {}  # the runs' numbers by what is started; "" stands for the programs
    for player in (player for found in players.values() for player in found):
        run = player.run
        is_solitary = run.setting == "alone" and not {*run.programs}.isdisjoint(shut_out)
        is_launched = run.setting == "launched"
        started = run.programs[0] if is_solitary else f"#{player.number}" if is_launched else ""
        numbers.setdefault(started, set()).add(player.number)
    solitary = [_only(players, numbers.pop(name)) for name in shut_out if name in numbers]
    lone = {_base(player.node) for way in solitary for player in _all(way)}
    ways = [
        _only(players, found)
        for _, found in sorted(numbers.items(), key=lambda pair: (pair[0] != "", *pair[1]))
    ]
    # Which of two programs that exclude each other ran is chance: the other must be better by a topic.
    best = max((_completed(way, ways, lone) for way in ways), key=_worth, default={})
    return max([best, *solitary], key=lambda way: _worth(way)[0])


def shut_out(runs: Sequence[Run]) -> dict[str, str]:
    """Return the programs that run alone but not beside the others; with the last output of each there.

    Beside the others such a program ends before any command, or has none of the topics and services that it
    has alone, or publishes nothing on the topics on which it publishes repeatedly alone.
    """
    alone = {run.programs[0]: run for run in runs if run.setting == "alone" and not run.ended}
    found: dict[str, str] = {}
    for run in runs:
        # A run that could not be watched to its end tells nothing.
        if run.setting != "together" or run.unfinished or not (run.nodes or run.ended):
            continue
        there = _ends(run)
        for name in run.programs:
            own = _ends(alone[name]) if name in alone else set()
            if name in alone and name in run.early:
                found[name] = run.ended[name]
            elif own and name not in run.ended and (own.isdisjoint(there) or _is_silent(alone[name], run)):
                found[name] = ""
    return found


def _is_silent(alone: Run, together: Run) -> bool:
    """Return whether a program's repeated topics are all silent beside the others, while something works.

    What was not listened to is not silent.
    """
    told = {topic for topic, heard in alone.quiet.items() if heard.count > 2}
    if not told.isdisjoint(together.torn):
        return False
    heard = {topic for topics in together.stretches for topic, heard in topics.items() if heard.count}
    is_at_work = bool(heard) or any(command.log for command in together.commands)
    return bool(told) and told.isdisjoint(heard) and is_at_work


def _ends(run: Run) -> set[tuple[str, str]]:
    """Return the ends of a run's nodes: publishers, subscriptions and services, each with its topic."""
    kinds = (("publishes", run.publishes), ("subscribes", run.subscribes), ("provides", run.services))
    return {(kind, topic) for kind, topics in kinds for topic in topics}


def _only(players: Mapping[str, Sequence[Player]], numbers: set[int]) -> Way:
    """Return the players in the runs with these numbers, by part."""
    found = {
        name: [player for player in everybody if player.number in numbers]
        for name, everybody in players.items()
    }
    return {name: some for name, some in found.items() if some}


def _completed(way: Way, ways: Iterable[Way], lone: Collection[str]) -> Way:
    """Return a way together with what can be started beside it.

    Args:
        way: the way itself.
        ways: all ways.
        lone: the nodes that do not run beside others: a launch file that starts one of them cannot be
            combined.
    """
    whole = dict(way)
    if _launches(way, lone):
        return whole
    ways = [candidate for candidate in ways if not _launches(candidate, lone)]
    for candidate in sorted(
        ways, key=lambda candidate: (_is_launched(candidate), _worth(candidate)), reverse=True
    ):
        if _is_launched(candidate) and not candidate.keys().isdisjoint(whole):
            continue  # it can only be started as a whole
        started = _launched_in(whole)
        whole |= {
            name: players
            for name, players in candidate.items()
            if name not in whole and started.isdisjoint(_base(player.node) for player in players)
        }
    return whole


def _launches(way: Way, nodes: Collection[str]) -> bool:
    return not _launched_in(way).isdisjoint(nodes)


def _launched_in(way: Way) -> set[str]:
    """Return the nodes that a launch file starts in a way."""
    launched = (player.run for player in _all(way) if player.run.setting == "launched")
    return {_base(node) for run in launched for node in run.nodes}


def _is_launched(way: Way) -> bool:
    return any(player.run.setting == "launched" for player in _all(way))


def _all(way: Way) -> list[Player]:
    return [player for players in way.values() for player in players]


def _base(node: str) -> str:
    """Return the name of a node without its namespace."""
    return node.rpartition("/")[2]


def _worth(way: Way) -> tuple[int, int, int]:
    """Return how many topics of a way are right, how much comes on them as asked, and how near the other topics are."""
    best = [min(MATCHES.index(player.match) for player in players) for players in way.values()]
    return best.count(0), sum(map(_spoken, way.values())), sum(len(MATCHES) - rank for rank in best)


def _spoken(players: Sequence[Player]) -> int:
    """Return 2 if something comes from a publisher with its period, 1 if without, 0 if nothing comes."""
    is_heard = any(player.part.is_publisher and player.is_heard for player in players)
    return is_heard + _has_period(players)


def _has_period(players: Sequence[Player]) -> bool:
    periods = [(player.part.period, period_of(player)) for player in players]
    return any(asked and period is not None and has_period(period, asked) for asked, period in periods)
