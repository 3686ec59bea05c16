"""What must come of a student's cells, and what is stored of them."""

from __future__ import annotations

import copy
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import nbformat
import pytest
from lesson_way import Outcome, Run
from nbval.plugin import IPyNbCell, IPyNbFile, coalesce_streams, get_sanitize_patterns

SANITIZERS = Path(__file__).parents[1] / "notebooks" / "sanitize.cfg"
AFTER_A_TRIAL = Path(__file__).with_name("after_a_trial.cfg")
NOT_YET = re.compile(r"Not yet\. Expected: .+\. Found: .+\. Hint: \w.+", re.DOTALL)


class StoredOutputs:
    """The outputs of a worked notebook, compared by nbval.

    Args:
        path: the notebook.
        runs: the way through it; a cell that is tried before it is answered may show traces of that.
        session: of this pytest.
    """

    def __init__(self, path: Path, runs: Sequence[Run], session: pytest.Session) -> None:
        tried = {run.index for run in runs if not run.is_answered}
        after_a_trial = _code_cells(path, session, SANITIZERS, AFTER_A_TRIAL)
        self._cells = _code_cells(path, session, SANITIZERS) | {
            index: after_a_trial[index] for index in tried
        }

    def difference(self, index: int, outputs: list[Any]) -> str:
        """Return in what a cell's outputs differ from those that are stored; nothing if they do not."""
        cell = self._cells[index]
        new, old = (coalesce_streams(copy.deepcopy(both)) for both in (outputs, cell.cell.outputs))
        return "" if cell.compare_outputs(new, old) else "\n".join(cell.comparison_traceback)


def _code_cells(path: Path, session: pytest.Session, *sanitizers: Path) -> dict[int, IPyNbCell]:
    """Return nbval's tests of a notebook's code cells, by the cells' places."""
    file = IPyNbFile.from_parent(session, path=path)
    for sanitizer in sanitizers:
        file.sanitize_patterns.update(get_sanitize_patterns(sanitizer.read_text(encoding="utf-8")))
    tests = iter(file.collect())
    cells = nbformat.read(path, as_version=4).cells
    return {index: next(tests) for index, cell in enumerate(cells) if cell.cell_type == "code"}


def what_is_wrong(run: Run, outputs: list[Any]) -> str:
    """Return what should not have come of a run; nothing if all is as it should be."""
    errors = [output for output in outputs if output.output_type == "error"]
    text = "\n".join(line for error in errors for line in error.traceback)
    if run.outcome is Outcome.NOT_YET:
        is_refused = [error.ename for error in errors] == ["CheckError"] and NOT_YET.search(text)
        return "" if is_refused else f"This check did not refuse what was delivered: {text or outputs}"
    if errors:
        return f"{'With the answer' if run.is_answered else 'As delivered'}:\n{text}"
    if run.outcome is Outcome.RIGHT and not any(map(says_right, outputs)):
        return f"This check did not say Right: {outputs}"
    if run.outcome is Outcome.ASKED and not any(map(asks, outputs)):
        return f"This quiz was not blank: {outputs}"
    return ""


def says_right(output: Any) -> bool:
    """Return whether an output is what a check returns for a right answer."""
    return str(output.get("data", {}).get("text/plain")).startswith("Right")


def asks(output: Any) -> bool:
    """Return whether an output is a quiz of which no question is answered."""
    return str(output.get("data", {}).get("text/plain")).startswith("Quiz: 0 of ")
