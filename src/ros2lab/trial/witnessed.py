"""Findings from the conditions and loops that were recorded while nodes ran."""

from __future__ import annotations

import ast
import contextlib
import json
import os
import shutil
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import spot_at
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.spelling import with_article
from ros2lab.trial.witness import WATCHED

LEAST = 3  # evaluations of a condition, or runs of a loop
MOST = 3  # conditions that are reported
# Codes that the sources alone may lead to, too: they are reported once per file.
NOTED = frozenset(("changed-in-loop", "used-up", "never-equal"))
_ONCE = frozenset(("map", "zip", "filter", "generator", "enumerate", "reversed", "islice", "chain"))
_DENIALS = (ast.NotEq, ast.NotIn, ast.IsNot)
_Spot = tuple[PythonSource, int, int]  # a file, a line and a column


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
    shutil.copyfile(Path(__file__).with_name("witness.py"), home / "sitecustomize.py")
    path = os.pathsep.join(filter(None, (str(home), own.get("PYTHONPATH", ""))))
    folders = (noted, root / "src", root / "install", root / "build")
    return {"PYTHONPATH": path, WATCHED: os.pathsep.join(map(str, folders))}


# The functions that were called, and the classes of their objects: their files and lines.
Called = frozenset[tuple[PythonSource, int]]


def witnessed(folder: Path, look: Look) -> tuple[list[Finding], list[Finding], Called]:
    """Return what was noted: certain findings, those about conditions that were never true, and what was called.

    Args:
        folder: the folder with the notes.
        look: the workspace.
    """
    sources = [source for package in look.packages for source in look.sources(package).sources.values()]
    by_text = {source.text: source for source in sources if source.path}
    conditions: dict[_Spot, list[Any]] = {}
    loops = defaultdict[_Spot, list[Any]](list)
    called = set[tuple[PythonSource, int]]()
    for file in sorted((folder / "noted").glob("*.json")):
        with contextlib.suppress(OSError, ValueError):
            told = json.loads(file.read_text(encoding="utf-8"))
            for spot, (held, failed, sides) in _spots(told["conditions"], by_text):
                before = conditions.get(spot, [0, 0, []])
                conditions[spot] = [before[0] + held, before[1] + failed, sides or before[2]]
            for spot, turns in _spots(told["loops"], by_text):
                loops[spot] += turns
            called |= {(source, line) for (source, line, _), _ in _spots(told["calls"], by_text)}
            called |= {*_classes(told["classes"], by_text)}
    never = [*_never_true(conditions)]
    wrong = [*_cut_short(loops), *(finding for finding, is_near in never if is_near)]
    return wrong, [finding for finding, is_near in never if not is_near][:MOST], frozenset(called)


def _spots(told: Mapping[str, Any], by_text: Mapping[str, PythonSource]) -> Iterator[tuple[_Spot, Any]]:
    """Yield what was noted with its place in the sources, which an installed copy has by its text."""
    for key, found in told.items():
        path, line, column = key.rsplit(":", 2)
        with contextlib.suppress(OSError, UnicodeError):
            if source := by_text.get(Path(path).read_text(encoding="utf-8")):
                yield (source, int(line), int(column)), found


def _classes(
    told: Sequence[Sequence[str]], by_text: Mapping[str, PythonSource]
) -> Iterator[tuple[PythonSource, int]]:
    """Yield where the classes of the objects are written."""
    for path, name in told:
        with contextlib.suppress(OSError, UnicodeError):
            source = by_text.get(Path(path).read_text(encoding="utf-8"))
            body: Sequence[ast.stmt] = source.tree.body if source else ()
            for node in body:
                if source and isinstance(node, ast.ClassDef) and node.name == name:
                    yield source, node.lineno


def _cut_short(loops: Mapping[_Spot, Sequence[Any]]) -> Iterator[Finding]:
    """Yield loops over something that lost items meanwhile, or that yields its items only once."""
    for (source, line, column), turns in loops.items():
        node = _node(source, line, column, ast.expr)
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


def _never_true(conditions: Mapping[_Spot, Sequence[Any]]) -> Iterator[tuple[Finding, bool]]:
    """Yield comparisons that were never true, and whether the two sides were nearly equal.

    Those with nearly equal sides come first, then those with ==.
    """
    found = []
    for (source, line, column), (held, failed, sides) in conditions.items():
        node = _node(source, line, column, ast.Compare)
        if not isinstance(node, ast.Compare) or held or failed < LEAST or "None" in sides or len(sides) != 2:
            continue
        left, right = ast.unparse(node.left), ast.unparse(node.comparators[0])
        is_equal = isinstance(node.ops[0], ast.Eq)
        if isinstance(node.ops[0], _DENIALS) or _is_of_module(node):
            continue  # a guard that never fires is as it should be, and so is an imported module's __name__
        last = [
            f"{text} was {value}" for text, value in ((left, sides[0]), (right, sides[1])) if text != value
        ]
        cause = f"During the run, `{ast.unparse(node)}` was never true in {failed} checks; at the last one, {' and '.join(last)}."
        change = _made_alike(*sides) if is_equal else ""
        above = min(at for at, compared_text in _compared(source) if compared_text == left)
        fix = (
            f"write `{left} = {left}{change}` above line {above}"
            if change
            else f"check what {left} should be there"
        )
        found.append(
            (
                not change,
                not is_equal,
                source.shown,
                line,
                Finding("never-equal", cause, source.at(line), fix),
            )
        )
    yield from ((finding, not is_far) for is_far, *_, finding in sorted(found, key=lambda row: row[:4]))


def _is_of_module(node: ast.Compare) -> bool:
    """Return whether a comparison asks how its own file was started."""
    return any(isinstance(inner, ast.Name) and inner.id == "__name__" for inner in ast.walk(node))


def is_idle(finding: Finding, look: Look, called: Called) -> bool:
    """Return whether a finding says that a function runs again and again which never ran, although its file did."""
    if finding.code not in ("timer-in-callback", "made-again"):
        return False
    spot = spot_at(finding.place, look)
    ran = {line for source, line in called if source == spot.source}
    return spot.function is not None and bool(ran) and spot.function.lineno not in ran


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


def _node(source: PythonSource, line: int, column: int, kind: type[ast.expr]) -> ast.expr | None:
    """Return the outermost expression of a kind that begins at a place; None if there is none."""
    return next(
        (
            node
            for node in source.nodes
            if isinstance(node, kind) and (node.lineno, node.col_offset) == (line, column)
        ),
        None,
    )
