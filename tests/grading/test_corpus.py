"""Submissions of the corpus get what they must: each style its full marks, each fault its cost and no other.

Some of each kind, for all of them take more than an hour: `make corpus` grades those.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import evidences
import pytest
from corpus import CASES, EXTREMES, FAULTS, HINTS, HOSTILE, PAIRS, STYLES
from corpus.case import Case
from corpus.graded import WORKSPACE, disappointments, graded
from corpus.hints import Hint
from corpus.tree import as_folder, made

from ros2lab.grading.files import look
from ros2lab.grading.grade import Grade
from ros2lab.grading.rubric import load
from ros2lab.grading.submission import receive
from ros2lab.grading.verdict import verdict

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


# Those about files alone: a run would tell no more of them.
OF_FILES = [hint for hint in HINTS if hint.criterion.startswith(("workspace", "package", "documentation"))]


@pytest.mark.parametrize(
    "hint",
    [hint for hint in OF_FILES if hint.criterion != "package.executables"],
    ids=lambda hint: hint.name,
)
def test_a_hint_about_files_keeps_what_it_promises(hint: Hint, tmp_path: Path) -> None:
    """What it is about has more points, and no component fewer; all that runs is taken to be right."""
    before = hint.case.make(tmp_path / "before", {})
    files = {str(path.relative_to(before)): path.read_text() for path in before.rglob("*") if path.is_file()}
    after = as_folder(made(files, hint.change), WORKSPACE)(tmp_path / "after", {})
    grades = [_of_files(path, tmp_path / f"received {path.parent.name}") for path in (before, after)]
    assert [*disappointments(hint, *grades)] == []


def _of_files(path: Path, root: Path) -> Grade:
    root.mkdir()
    submission = receive(path, root)
    right = evidences.right()
    facts = replace(look(root, submission), readme_commands=right.files.readme_commands)
    return verdict(replace(right, files=facts, submission=submission), load())


def test_a_wrong_expectation_is_objected_to(tmp_path: Path) -> None:
    """So a right outcome means something: here a fault is graded as if it were a style."""
    fault = next(case for case in FAULTS if case.loses and "documentation" in case.loses)
    as_style = Case(fault.name, fault.about, fault.make)
    assert any("must lose none" in problem for problem in graded(as_style, tmp_path).problems)
