"""Which programs do something else on the real clock than on the stepped one.

By whatever a program may know that a clock is simulated (its value, a parameter, a topic, a word of its command),
what it does then tells: so what was seen on the stepped clock must be seen on the real one, too.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

from ros2lab.grading.evidence import CommandSeen, Heard, Run
from ros2lab.grading.senses import is_still, is_velocity, steady
from ros2lab.rhythm import LEAST_CHANGE, REAL_HORIZON, is_another, period_of

MOVING, STILL = "moving", "still"
LISTENED = 3  # messages of each topic, after which nobody waits for more of them on the real clock


def otherwise(runs: Iterable[Run], reals: Iterable[Run]) -> Iterator[str]:
    """Yield the programs that do something else on the real clock.

    Args:
        runs: the runs so far; only programs that were seen alone on the stepped clock are compared.
        reals: runs on the real clock of programs as `ros2 run` starts them: all together if what each does was seen
            so on the stepped clock, else each alone.
    """
    stepped = [run for run in runs if run.clock == "stepped" and run.setting in ("alone", "together")]
    alone = {run.programs[0]: run for run in stepped if run.setting == "alone" and not run.ended}
    for real in reals:
        together = [run for run in stepped if run.setting == "together" and len(real.programs) > 1]
        for name in real.programs:
            if name in alone and (name in real.ended or _is_other(alone[name], together, real)):
                yield name


def _is_other(alone: Run, together: Sequence[Run], real: Run) -> bool:
    return (
        any(_is_paced_otherwise(heard, real.quiet.get(topic)) for topic, heard in alone.quiet.items())
        or any(_is_unsaid(topic, [alone, *together], real) for topic in alone.publishes)
        or _is_untold(alone, real)
    )


def _is_paced_otherwise(stepped: Heard, real: Heard | None) -> bool:
    """Return whether messages have another period before any command, or fewer come than theirs makes then."""
    period = period_of(stepped.times)
    if period is None:
        return False
    if (real.count if real else 0) < min(REAL_HORIZON // (LEAST_CHANGE * period), LISTENED):
        return True
    other = period_of(real.times) if real else None
    if real is None or other is None:
        return False
    # A loop that is late on a busy machine catches up: then as many messages come.
    return is_another(period, other) and is_another(period, _mean(real.times))


def _mean(times: Sequence[float]) -> float:
    return (times[-1] - times[0]) / (len(times) - 1)


def _is_unsaid(topic: str, stepped: Sequence[Run], real: Run) -> bool:
    """Return whether nothing that a topic said, or no motion, is said on the real clock, either at once or after a command."""
    words = {command.text for command in real.commands}
    wanted = {saying for run in stepped for saying in _said(topic, run, words)}
    missing = wanted - {saying for heard in _heard(topic, real) for saying in map(_saying, heard.values)}
    return bool(missing) and (missing == wanted or MOVING in missing)


def _said(topic: str, run: Run, words: Collection[str]) -> Iterator[str]:
    """Yield what a topic says so early that it is also said on the real clock, and after some commands."""
    quiet = run.quiet.get(topic)
    for time, value in zip(quiet.times, quiet.values, strict=True) if quiet else ():
        if LEAST_CHANGE * time < REAL_HORIZON:
            yield _saying(value)
    for command in _first(run, words):
        if topic in command.topics:
            yield from map(_saying, command.topics[topic].values)


def _saying(value: object) -> str:
    if is_velocity(value):
        return STILL if is_still(value) else MOVING
    return steady(str(value))


def _heard(topic: str, run: Run) -> list[Heard]:
    return [topics[topic] for topics in run.stretches if topic in topics]


def _is_untold(alone: Run, real: Run) -> bool:
    """Return whether a program logs lines after a command, and none of them on the real clock."""
    told = {
        _line(line) for lines in (real.log, *(command.log for command in real.commands)) for line in lines
    }
    words = {command.text for command in real.commands}
    lines = ({*map(_line, command.log)} for command in _first(alone, words))
    return any(found and found.isdisjoint(told) for found in lines)


def _first(run: Run, words: Collection[str]) -> list[CommandSeen]:
    """Return what followed each of some words when it was first said."""
    return [*{command.text: command for command in reversed(run.commands) if command.text in words}.values()]


def _line(line: Sequence[str]) -> str:
    return steady(line[1])
