"""A line at which Python or launch stops: try changes on copies of its file, and suggest what is accepted there.

A fix that is known already is tried first, word by word, as a student would apply it.
"""

from __future__ import annotations

import ast
import itertools
import math
import re
from collections.abc import Sequence
from dataclasses import replace

from ros2lab.diagnose.causes.nothing_given import of_what_gives_nothing
from ros2lab.diagnose.causes.origins import Origin
from ros2lab.diagnose.checking.checked_copies import RULES, checked
from ros2lab.diagnose.checking.edits import Edit, edits_told
from ros2lab.diagnose.checking.trials import UNKNOWN_TYPE, Trial, statement_of, type_of
from ros2lab.diagnose.code.at_hand import IF_TEXT
from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.launching.launch_loaded import load_copies
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.mending.changes import LESS, MOST, MOST_TOLD, PLACE, Change, changes_of, origins_of
from ros2lab.diagnose.printed.spots import Spot, source_of, spot_at
from ros2lab.diagnose.sources.calls import missing_imports
from ros2lab.diagnose.sources.python_source import PythonSource


def tried(
    finding: Finding, look: Look, part: str = "", *, is_sure: bool = False, passed_on: Finding | None = None
) -> Finding:
    """Return a finding about a line of Python with a fix that works, if one is known or found.

    A fix that can be applied word by word stays if the type checker accepts it; otherwise a change that it accepts
    replaces it. Without the type checker, or where it has no objection to begin with, nothing changes.

    Args:
        finding: what is known.
        look: the workspace.
        part: the part of the line that failed, as Python marks it.
        is_sure: whether a fix that cannot be applied word by word is right all the same.
        passed_on: what launch itself says, if it could not go on.
    """
    file, _, number = finding.place.rpartition(":")
    line = int(number) if number.isdigit() else 0
    file = file if line else finding.place
    source = source_of(file, look) if file.endswith(".py") else None
    if source is None or not source.tree.body:
        return finding
    if source.path in look.launch_paths and look.loads and passed_on and not is_sure:
        return loaded(finding, source, line, look, passed_on) or finding
    trial = Trial(source, replace(Spot(source, line), part=part), look) if line else None
    return _checked(finding, trial, is_sure=is_sure) if trial and trial.objections else finding


def worth_typing(finding: Finding, look: Look) -> Finding:
    """Return a finding whose fix names the imports that it needs; a fix that changes nothing is removed."""
    spot = spot_at(finding.place, look)
    finding = _without_guess(finding, spot)
    if spot.source is not None and finding.fix.startswith("write "):
        statement = statement_of(spot)
        inner = [n for n in ast.walk(statement or ast.Pass()) if isinstance(n, ast.expr)]
        said = [*edits_told(finding.fix, statement, inner)]
        if said and all(edit.is_idle(spot.source) for edit in said):
            finding = replace(finding, fix="")
    return _with_imports(finding, look)


def _without_guess(finding: Finding, spot: Spot) -> Finding:
    """Return a finding with its other fix if what the first one writes makes something else in the file fail."""
    guess, source, statement = finding.guess, spot.source, statement_of(spot)
    here = [n for n in spot.nodes if isinstance(n, (ast.expr, ast.stmt))]
    edits = [Edit(n, guess.new) for n in here if guess and ast.unparse(n) == guess.old]
    first, _, otherwise = finding.fix.partition(IF_TEXT)
    if is_text := bool(otherwise):
        edits = [*edits_told(first, statement, [n for n in here if isinstance(n, ast.expr)])]
    if source is None or not edits:
        return finding
    before, after = checked(source, [source.text.encode(), edits[0].of(source)])
    known = {(row.rule, row.said) for row in before}
    new = [row for row in after if (is_text or row.rule in _FAILS) and (row.rule, row.said) not in known]
    holders = [n.value for n in getattr(statement, "targets", ()) if is_text and isinstance(n, ast.Attribute)]
    is_open = any(UNKNOWN_TYPE.search(type_of(source, holder) or "Unknown") for holder in holders)
    cause = finding.cause.partition(" Did you mean")[0]
    otherwise = guess.otherwise if guess else otherwise
    return replace(finding, cause=cause, fix=otherwise) if new or is_open else finding


# Objections of the type checker to what fails whatever the annotations say.
_FAILS = frozenset(RULES) - {"invalid-argument-type", "unsupported-operator", "missing-union-attribute"}


def _with_imports(finding: Finding, look: Look) -> Finding:
    """Return a finding whose fix names the missing imports of the classes that it writes into Python."""
    is_written = ".py:" in finding.place and finding.fix.startswith("write ") and "import" not in finding.fix
    source = spot_at(finding.place, look).file
    # What could not be read is only completed, so it needs nothing new.
    is_read = is_written and source.text and source.readable_to == math.inf
    lines = missing_imports(source, finding.fix) if is_read else []
    more = f", with `{'; '.join(lines)}` at the top" if lines else ""
    return replace(finding, fix=f"{finding.fix}{more}")


def _checked(finding: Finding, trial: Trial, *, is_sure: bool) -> Finding:
    """Return a finding about a line that the type checker objects to, with a fix that it accepts."""
    if nothing := _of_nothing(trial):
        return nothing
    said = [*edits_told(finding.fix, trial.statement, trial.expressions())]
    if any(trial.stands([edit for edit in said if not trial.is_open(edit.text)])) or (is_sure and not said):
        return finding
    good = _cheapest(trial, sorted(changes_of(trial), key=lambda change: change.cost)[:MOST])
    if not good:
        return finding
    place = trial.source.at(good[0].node)
    more = "" if place == finding.place else f" Line {trial.spot.line} fails because of this one."
    texts = map(trial.told, good)
    cause = finding.cause.partition(" Did you mean")[0]  # that was a guess
    return replace(finding, cause=f"{cause}{more}", place=place, fix=f"write {', or '.join(texts)}")


def _of_nothing(trial: Trial) -> Finding | None:
    """Return a finding about a call that returns nothing, whose value the line uses; None if none."""
    for text, value in origins_of(trial.expressions(), trial).items():
        if trial.kind(text) == "None" and isinstance(value, ast.Call):
            origin = Origin(text, value, trial.source, value.lineno, "NoneType")
            return Finding("made-wrong", *of_what_gives_nothing(origin, value, trial.spot))
    return None


_IS_FUNCTION = re.compile("bound method|def |\\(")


def _cheapest(trial: Trial, changes: Sequence[Change]) -> list[Edit]:
    """Return the cheapest change that works, or a few equally likely ones; empty if there are many."""
    stands = trial.stands([change.edit for change in changes])
    good = [change for change, is_good in zip(changes, stands, strict=True) if is_good]
    good = [change for change in good if trial.is_right(change.edit)]
    # A value of unknown type fits anywhere and has any member; a call with less still returns the same type.
    asked = {change: trial.asked_of(change.edit) for change in good}
    texts = [*(change.edit.text for change in good), *itertools.chain(*asked.values())]
    kinds = trial.kinds_of(list(dict.fromkeys(texts))) if good else {}
    unknown = {text for text, kind in kinds.items() if UNKNOWN_TYPE.search(kind)}
    # So a value of known type is never given up for one of unknown type.
    good = [c for c in good if not trial.kind(ast.unparse(c.edit.node)) or unknown.isdisjoint(asked[c])]
    # Nor a function that takes the values there for one that takes any.
    if all(row.rule == "invalid-argument-type" for row in trial.objections):
        good = [
            c for c in good if not (_IS_FUNCTION.match(kinds.get(c.edit.text, "")) and c.edit.text in unknown)
        ]
    return _first(good, [c for c in good if c.cost == LESS or c.edit.text not in unknown])


def _first(good: Sequence[Change], known: Sequence[Change]) -> list[Edit]:
    """Return the first change, or the few that cost the same: of those of a known type, else one that is alone."""
    for change in [*known, *(other for other in good if not other.is_one_of_many)]:
        same = [other.edit for other in known if other.cost == change.cost and other.is_one_of_many]
        if not change.is_one_of_many:
            return [change.edit]
        if len(same) <= MOST_TOLD:
            return same
    return []


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
