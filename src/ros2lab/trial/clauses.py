"""Clauses about the statements and tests of a run: the values that were compared, and which of them were still on their way."""

from __future__ import annotations

import ast
import contextlib
from collections.abc import Collection

from ros2lab.diagnose.finding import in_a_row
from ros2lab.trial.record import Side, Spot, Test

LEAST = 3  # evaluations of a test that say something
LONGEST = 70  # characters of a statement
ORDERS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)


def times(count: int) -> str:
    """Return how often something happened, in words."""
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def on_one_line(node: ast.AST) -> str:
    """Return the text of a statement on one line, shortened."""
    text = ast.unparse(node).splitlines()[0]
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."


def of_side(text: str, side: Side) -> str:
    """Return the values that one side of a test had, as a clause."""
    if side.bounds:
        least, most = (f"{float(bound):.6g}" for bound in side.bounds)
        return f"{text} was between {least} and {most}"
    return f"{text} was {side.last} {'the last' if side.has_changed else 'each'} time"


def values_of(test: ast.expr, found: Test) -> str:
    """Return the values that the sides of a test had, as clauses; empty if they say no more than their names."""
    parts = [test.left, *test.comparators] if isinstance(test, ast.Compare) else [test]
    pairs = zip(map(ast.unparse, parts), found.sides, strict=False)  # what has parts has no sides
    return in_a_row([of_side(text, side) for text, side in pairs if side.last not in ("", text)])


def truth(wanted: bool) -> str:
    """Return what a test was that should have been the one or the other."""
    return "never true" if wanted else "always true"


def checks_in_words(count: int) -> str:
    """Return how often a test was evaluated, in words."""
    return f"{count} checks" if count > 1 else "the only check"


def is_plain(value: str) -> bool:
    """Return whether what is shown of a value is the value itself."""
    try:
        ast.literal_eval(value)
    except (ValueError, SyntaxError):
        return False
    return True


def is_coming(
    moving: Collection[Spot] | None, place: Spot, test: ast.expr, found: Test, *, wanted: bool
) -> bool:
    """Return whether a comparison may only not have become true, or false, so far.

    A number in it still moved when a longer run ended, as is told of those in `moving`. If that is None, it only went
    towards the other side, or has not changed often enough to tell.
    """
    if not isinstance(test, ast.Compare) or not any(side.bounds for side in found.sides):
        return False
    if moving is not None and found.checks >= LEAST:
        return place in moving
    sign, (left, right) = test.ops[0], found.sides[:2]
    rises = isinstance(sign, (ast.Gt, ast.GtE)) is wanted
    if isinstance(sign, ast.Eq):
        with contextlib.suppress(ValueError):
            rises = float(left.last) < float(right.last)
    elif not isinstance(sign, ORDERS):
        return False
    return found.checks < LEAST or left.way == (1 if rises else -1) or right.way == (-1 if rises else 1)
