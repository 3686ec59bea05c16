"""A launch file that launch refuses: load changed copies of it, and suggest what starts most."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import replace

from ros2lab.diagnose.checking.edits import edits_told
from ros2lab.diagnose.checking.trials import Trial
from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.launching.launch_loaded import load_copies
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.mending.changes import MOST, MOST_TOLD, PLACE, Change, changes_of
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.python_source import PythonSource

_TOLD = 0  # the cost of a change that is suggested already


_Way = tuple[Trial, Change]  # a change, with the trial of the line that it changes


def loaded(
    finding: Finding, source: PythonSource, line: int, look: Look, passed_on: Finding
) -> Finding | None:
    """Return a finding with the cheapest change by which launch starts most; None if none is known.

    The line is 0 if launch, which says what is passed on, names none.
    """
    path = source.path
    if path is None or load_copies(path, [source.text.encode()], look.packages) != [None]:
        return None
    trials = [Trial(source, Spot(source, number), look) for number in ([line] if line else _lines(source))]
    ways = [
        (trial, Change(edit, _TOLD))
        for trial in trials
        for edit in edits_told(finding.fix, trial.statement, trial.expressions())
    ]
    is_guess = bool(ways)
    said = f"{finding.cause} {passed_on.cause}"
    ways += [(trial, change) for trial in trials for change in changes_of(trial, said)]
    if finding in look.findings and finding.code != SAID:
        # What a rule says of the line is right: only a small change may replace its fix.
        ways = [(trial, change) for trial, change in ways if change.cost <= PLACE]
    good = _best(sorted(ways, key=lambda way: way[1].cost)[:MOST], source, look)
    if not good:
        return None
    best = good[0][1]
    if best.cost == _TOLD:
        return finding
    texts = _told(good)
    if len(texts) > MOST_TOLD:
        return None
    known = passed_on if is_guess else finding  # the fix so far does not help
    place = source.at(best.edit.node)
    return replace(known, place=place, fix=f"write {', or '.join(texts)}")


def _lines(source: PythonSource) -> list[int]:
    """Return the lines of a file's functions and of the statements in them."""
    statements = (node for node in source.nodes if isinstance(node, ast.stmt))
    return [n.lineno for n in statements if n.col_offset or isinstance(n, ast.FunctionDef)]


def _best(ways: Sequence[_Way], source: PythonSource, look: Look) -> list[_Way]:
    """Return the changes by which launch starts most; where it starts nothing, only the small ones."""
    assert source.path is not None
    copies = [trial.copy_with(change.edit) for trial, change in ways]
    counts = load_copies(source.path, copies, look.packages)
    most = max((count for count in counts if count is not None), default=0)
    # Where something outside the file is missing, any other value gets launch further.
    return [way for way, n in zip(ways, counts, strict=True) if n == most and (n or way[1].cost <= PLACE)]


def _told(good: Sequence[_Way]) -> list[str]:
    """Return what the cheapest changes write: only the first, unless nothing speaks for any of them."""
    best = good[0][1]
    same = [trial.told(change.edit) for trial, change in good if change.cost == best.cost]
    return [*dict.fromkeys(same if best.is_one_of_many else same[:1])]
