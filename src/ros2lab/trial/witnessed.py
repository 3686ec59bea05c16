"""Findings from the conditions and loops that were recorded while nodes ran."""

from __future__ import annotations

import ast
import contextlib
import os
import shutil
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from ros2lab.diagnose.code.summed_floats import compared_nearly
from ros2lab.diagnose.explaining.shown_values import made_of_many
from ros2lab.diagnose.finding import Finding, fails_there
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import spot_at
from ros2lab.diagnose.sources.one_run import is_always_reached
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, own_nodes
from ros2lab.diagnose.sources.spelling import with_article
from ros2lab.trial.clauses import LEAST, is_coming
from ros2lab.trial.guards import asks_who_is_there, is_guard
from ros2lab.trial.held_back import swallowed
from ros2lab.trial.record import Record, Spot, Test, node_at
from ros2lab.trial.undone import undone_faults
from ros2lab.trial.unreached import Unreached
from ros2lab.trial.witness import WATCHED

_PACKAGE = "ros2lab_watching"  # that a running program imports
_BEGIN = f"from {_PACKAGE} import witness\n\nwitness.begin()\nwitness.make_room()\n"
MOST = 3  # conditions that are reported
# Codes that the sources alone may lead to, too: they are reported once per file.
NOTED = frozenset(("changed-in-loop", "used-up", "never-equal"))
_ONCE = frozenset(("map", "zip", "filter", "generator", "enumerate", "reversed", "islice", "chain"))
_SIMPLE = (ast.Expr, ast.Assign, ast.AnnAssign, ast.AugAssign, ast.Import, ast.ImportFrom, ast.Delete)
_DENIALS = (ast.NotEq, ast.NotIn, ast.IsNot)


def environ_in(folder: Path, root: Path, own: Mapping[str, str]) -> dict[str, str]:
    """Create folders for the recording, and return the environment variables that turn it on.

    Args:
        folder: the folder for the notes.
        root: the workspace whose files are watched.
        own: the environment variables that the programs have.
    """
    home, noted = folder / "witness", folder / "noted"
    for inner_folder in (home, noted):
        inner_folder.mkdir()
    (home / _PACKAGE).mkdir()
    (home / _PACKAGE / "__init__.py").touch()
    for name in ("witness", "changes", "sender", "values"):
        shutil.copyfile(Path(__file__).with_name(f"{name}.py"), home / _PACKAGE / f"{name}.py")
    (home / "sitecustomize.py").write_text(_BEGIN)
    path = os.pathsep.join(filter(None, (str(home), own.get("PYTHONPATH", ""))))
    folders = (noted, root / "src", root / "install", root / "build")
    return {"PYTHONPATH": path, WATCHED: os.pathsep.join(map(str, folders))}


# The functions that were called, and the classes of their objects: their files and lines.
Called = frozenset[tuple[PythonSource, int]]


@dataclass(frozen=True)
class Witnessed:
    """What was noted.

    Attributes:
        wrong: certain findings.
        never: those about conditions that were never true, although what they compare changed.
        steady: those about others, of which nothing that was compared ever changed: it may only not have come.
        called: what was called.
        done: the places of the statements that came to their end.
        unreached: why others did not.
        told: the places of the `except` clauses whose errors are among the findings.
    """

    wrong: list[Finding]
    never: list[Finding]
    steady: list[Finding]
    called: Called
    done: frozenset[str]
    unreached: Unreached
    told: frozenset[str]

    @cached_property
    def ran(self) -> set[str]:
        """The places of what was called."""
        return {source.at(line) for source, line in self.called}


def witnessed(folder: Path, look: Look, moving: Collection[Spot] | None = None) -> Witnessed:
    """Return what was noted.

    Args:
        folder: the folder with the notes.
        look: the workspace.
        moving: the tests whose values still moved when the runs ended, of which nothing is said.
    """
    record = Record(folder, look, moving)
    nans = dict(nan_faults(record))
    never = [(one, how) for one, how in _never_true(record) if one.place not in nans.values()]
    near, changed, steady = ([one for one, how in never if how == kind] for kind in ("near", "changed", ""))
    unreached = Unreached(record, look)
    hidden = [*swallowed(unreached)]
    called = record.classes | {(source, node.lineno) for source, node in record.marked(Function)}
    done = {source.at(node) for source, node in record.marked(_SIMPLE)}
    return Witnessed(
        [
            *_cut_short(record.loops),
            *near,
            *nans,
            *undone_faults(record),
            *(finding for finding, _ in hidden),
        ],
        changed[:MOST],
        steady[:MOST],
        frozenset(called),
        frozenset(done),
        unreached,
        frozenset(place for _, place in hidden),
    )


def _cut_short(loops: Mapping[Spot, Sequence[Any]]) -> Iterator[Finding]:
    """Yield loops over something that lost items meanwhile, or that yields its items only once."""
    for (source, line, *ends), turns in loops.items():
        node = node_at((source, line, *ends), ast.expr)
        whole = [(done, kind, least) for done, kind, least, is_left in turns if not is_left]
        text = ast.unparse(node) if node else ""
        lost = next(((done, least) for done, _, least in whole if least and done < least), None)
        if text and lost:
            cause = f"The loop over {text} ran {lost[0]} times, although there were {lost[1]} items at the start: the loop changes what it iterates over."
            yield Finding(
                "changed-in-loop", cause, source.at(line), f"write `in list({text})`, which is a copy"
            )
        elif text and _is_used_up(whole):
            cause = f"The loop over {text} ran {whole[0][0]} times the first time, but not at all the {len(whole) - 1} times after that: {with_article(whole[0][1])} yields its items only once."
            fix = f"write list(...) around the value given to {text}, which can be iterated over again"
            yield Finding("used-up", cause, source.at(line), fix)


def _is_used_up(whole: Sequence[Any]) -> bool:
    """Return whether a loop over a one-time iterable had iterations only the first time."""
    is_once = len(whole) >= LEAST and whole[0][1] in _ONCE
    return is_once and whole[0][0] > 0 and not any(done for done, *_ in whole[1:])


def _never_true(record: Record) -> Iterator[tuple[Finding, str]]:
    """Yield comparisons that were never true, and how far the two sides came: "near" each other, or "changed".

    Those with ==, and then the others, in the order of the files.
    """
    found = []
    for place, test in record.tests.items():
        source, line, node = place[0], place[1], node_at(place, ast.Compare)
        sides, near = [side.last for side in test.sides], test.near
        if not isinstance(node, ast.Compare) or test.held or test.failed < LEAST or "None" in sides:
            continue
        if not near and is_coming(record.moving, place, node, test, wanted=True):
            continue
        if len(sides) != 2 or isinstance(node.ops[0], _DENIALS) or _is_of_module(node):
            continue  # a guard that never fires is as it should be, and so is an imported module's __name__
        if asks_who_is_there(source, node) or (not near and is_guard(source, node, test)):
            continue
        is_equal = isinstance(node.ops[0], ast.Eq)
        change = _made_alike(*sides) if is_equal else ""
        has_changed = any(side.has_changed for side in test.sides)
        how = "near" if change or near else "changed" if has_changed else ""
        finding = _of_comparison(source, node, test, change)
        found.append((not is_equal, source.shown, line, finding, how))
    yield from ((finding, how) for *_, finding, how in sorted(found, key=lambda row: row[:3]))


def _of_comparison(source: PythonSource, node: ast.Compare, test: Test, change: str) -> Finding:
    """Return the finding about a comparison that was never true; `change` makes its left side equal the right one."""
    left, right = ast.unparse(node.left), ast.unparse(node.comparators[0])
    shown = zip((left, right), test.near or [side.last for side in test.sides], strict=True)
    last = " and ".join(f"{text} was {value}" for text, value in shown if text != value)
    when = "one of them" if test.near else "the last one"
    cause = (
        f"During the run, `{ast.unparse(node)}` was never true in {test.checks} checks; at {when}, {last}."
    )
    fix = compared_nearly(source, left, right) if test.near else f"check what {left} should be there"
    if change:
        above = min(at for at, compared_text in _compared(source) if compared_text == left)
        fix = f"write `{left} = {left}{change}` above line {above}"
    return Finding("never-equal", cause, source.at(node), fix)


def _is_of_module(node: ast.Compare) -> bool:
    """Return whether a comparison asks how its own file was started."""
    return any(isinstance(inner, ast.Name) and inner.id == "__name__" for inner in ast.walk(node))


def is_contradicted(finding: Finding, look: Look, noted: Witnessed) -> bool:
    """Return whether the run did what a finding says cannot happen.

    Code that never runs ran, a line that fails came to its end, or a function did not run that runs again and again.
    """
    if not noted.ran.isdisjoint(finding.never):
        return True
    spot = spot_at(finding.place, look)
    if finding.code in ("timer-in-callback", "made-again"):
        has_run = any(source == spot.source for source, _ in noted.called)
        # With what was made up, it may have been called, which is not among the calls.
        inside = (
            []
            if spot.function is None
            else [node for node in ast.walk(spot.function) if isinstance(node, ast.stmt)]
        )
        is_called = any(spot.file.at(node) in noted.ran | noted.done for node in inside)
        return has_run and bool(inside) and not is_called
    statement = next((node for node in spot.whole if isinstance(node, ast.stmt)), None)
    if statement is None or spot.file.at(statement) not in noted.done or not fails_there(finding):
        return False
    # A part of the line may not have been evaluated, such as what is after an `or`.
    return all(is_always_reached(ast.Module([statement], []), node) for node in spot.nodes)


def _compared(source: PythonSource) -> Iterator[tuple[int, str]]:
    """Yield the line and the left side of each comparison."""
    return ((node.lineno, ast.unparse(node.left)) for node in source.nodes if isinstance(node, ast.Compare))


def _made_alike(shown: str, other_shown: str) -> str:
    """Return the string method that makes one shown string equal another; empty if there is none."""
    with contextlib.suppress(ValueError, SyntaxError):
        left, right = map(ast.literal_eval, (shown, other_shown))
        if isinstance(left, str) and isinstance(right, str):
            made = {
                ".strip()": left.strip(),
                ".lower()": left.lower(),
                ".strip().lower()": left.strip().lower(),
            }
            return next((change for change, text in made.items() if text == right), "")
    return ""


def nan_faults(record: Record) -> Iterator[tuple[Finding, str]]:
    """Yield what makes nan of values of which one is nan, each with the place where that was compared.

    A value that is nan itself may be left out by just this comparison, or mean that nothing is there.
    """
    for place, test in record.tests.items():
        source, node = place[0], node_at(place, ast.Compare)
        if not isinstance(node, ast.Compare) or isinstance(source.above(node), ast.UnaryOp):
            continue  # `not distance > 1.0` may be written for nan
        parts = (node.left, *node.comparators)
        if len({*map(ast.unparse, parts)}) < len(parts):
            continue  # `x != x` asks for nan
        for part, side in zip(parts, test.sides, strict=True):
            for found in made_of_many(source, _behind(source, part)) if side.nans >= LEAST else ():
                checks = f"{side.nans} of {test.held + test.failed} checks of `{ast.unparse(node)}`"
                cause = (
                    f"{found.cause} In the run, {ast.unparse(part)} was nan in {checks} (line {node.lineno})."
                )
                yield replace(found, cause=cause), source.at(node)


def _behind(source: PythonSource, part: ast.expr) -> list[ast.expr]:
    """Return an expression, what the names in it are given, and what functions of the file that are called there return."""
    named = [node for node in ast.walk(part) if isinstance(node, (ast.Name, ast.Attribute))]
    found = [part, *(value for node in named for value in source.given(node) if value)]
    calls = (node for value in found for node in ast.walk(value) if isinstance(node, ast.Call))
    called = {last_name(call.func) for call in calls}
    functions = (n for n in source.nodes if isinstance(n, Function) and n.name in called)
    inside = (node for function in functions for node in own_nodes(function))
    return [*found, *(node.value for node in inside if isinstance(node, ast.Return) and node.value)]
