"""Submissions of the corpus get what they must: each style its full marks, each fault its cost and no other.

Some of each kind, for all of them take more than an hour: `make corpus` grades those.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from corpus import CASES, EXTREMES, FAULTS, HINTS, HOSTILE, PAIRS, STYLES
from corpus.case import Case
from corpus.graded import followed, graded
from corpus.hints import Hint

OF_ANOTHER_ASSIGNMENT = ("lamp/components_over_modules", "lamp/dies_of_a_request")
SOME = (
    *STYLES[::24],
    *EXTREMES[::4],
    *FAULTS[::70],
    *PAIRS[::30],
    *HOSTILE[::40],
    *(case for case in CASES if case.name in OF_ANOTHER_ASSIGNMENT),
)


@pytest.mark.parametrize("case", SOME, ids=lambda case: case.name)
def test_it_gets_what_it_must(case: Case, tmp_path: Path) -> None:
    assert graded(case, tmp_path).problems == []


FOLLOWED = ("hint/package/no_init",)


@pytest.mark.parametrize(
    "hint", [hint for hint in HINTS if hint.name in FOLLOWED], ids=lambda hint: hint.name
)
def test_a_hint_keeps_what_it_promises(hint: Hint, tmp_path: Path) -> None:
    """What it is about has more points, and no component fewer."""
    assert followed(hint, tmp_path).problems == []


def test_a_wrong_expectation_is_objected_to(tmp_path: Path) -> None:
    """So a right outcome means something: here a fault is graded as if it were a style."""
    fault = next(case for case in FAULTS if case.loses and "documentation" in case.loses)
    as_style = Case(fault.name, fault.about, fault.make)
    assert any("must lose none" in problem for problem in graded(as_style, tmp_path).problems)
