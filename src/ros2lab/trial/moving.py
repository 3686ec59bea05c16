"""Which compared numbers still moved when a run ended: whether they come to a limit, only a longer run can tell."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence

from ros2lab.trial.record import Record, Side, Spot, Test


def may_move(record: Record) -> bool:
    """Return whether a test never had one of its truths while a number in it was at the end of its way so far."""
    return any(map(_is_open, record.tests.values()))


def still_moving(short: Record, longer: Record) -> set[Spot]:
    """Return the tests without one of their truths in which a number still moved when the longer of two runs ended.

    That is so if the number went further than in the short run, and has not turned back since. Without a longer
    run, nobody knows what stands still.
    """
    found = set[Spot]()
    for place, test in short.tests.items():
        last = longer.tests.get(place)
        whole = last.beside(test) if last else test
        if whole.held and whole.failed:
            continue
        before = test.sides if last else [None] * len(whole.sides)
        sides = [*zip((last or test).sides, before, strict=True)]
        moves = any(_is_at_its_end(side) and _went_on(side, earlier) for side, earlier in sides)
        if moves and not _is_passed(whole.sides):
            found.add(place)
    return found


def _is_open(test: Test) -> bool:
    return not (test.held and test.failed) and any(map(_is_at_its_end, test.sides))


def _is_at_its_end(side: Side) -> bool:
    """Return whether a number is at the least or the greatest value that it ever had."""
    return bool(side.bounds) and side.last in side.bounds


def _is_passed(sides: Sequence[Side]) -> bool:
    """Return whether a number was below and above the fixed one that it is compared with: it will not come again."""
    moving = [[*map(float, side.bounds)] for side in sides if side.bounds]
    fixed = list[float]()
    for side in sides:
        with contextlib.suppress(ValueError):
            fixed += [float(side.last)] * (not side.bounds)
    return any(low < number < high for low, high in moving for number in fixed)


def _went_on(side: Side, earlier: Side | None) -> bool:
    if earlier is None or not earlier.bounds:
        return True
    low, high = (float(bound) for bound in earlier.bounds)
    return float(side.bounds[0]) < low or float(side.bounds[1]) > high
