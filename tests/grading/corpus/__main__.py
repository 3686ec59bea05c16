"""Grade the corpus, and print a table: case, what it must get, what it got. `make corpus` calls it.

With words, only the cases whose names hold one of them. The exit code is 1 if a case did not get what it must.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import sys
from concurrent.futures import ProcessPoolExecutor

from rich.console import Console
from rich.progress import track
from rich.table import Table
from rich.text import Text

from corpus import CASES, HINTS
from corpus.case import COMPONENTS, Case
from corpus.graded import Outcome, outcome
from corpus.hints import Hint


def main() -> int:
    parser = argparse.ArgumentParser(prog="make corpus", description=__doc__)
    parser.add_argument("words", nargs="*", help="parts of names")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="how many at a time")
    options = parser.parse_args()
    cases = [
        case
        for case in (*CASES, *HINTS)
        if not options.words or any(word in case.name for word in options.words)
    ]
    names = [case.name for case in cases]
    # Processes, for each attack has a secret of its own in the environment.
    with ProcessPoolExecutor(options.jobs, multiprocessing.get_context("spawn")) as pool:
        outcomes = list(
            track(pool.map(outcome, names), "grading", total=len(names), console=Console(stderr=True))
        )
    table = Table("case", "must get", "has got", "right", show_lines=True)
    for case, one in zip(cases, outcomes, strict=True):
        said = "\n".join(one.problems) or "yes"
        table.add_row(*map(Text, (case.name, _expected(case), _given(one), said)))
    wrong = [case.name for case, one in zip(cases, outcomes, strict=True) if one.problems]
    console = Console() if sys.stdout.isatty() else Console(width=160)
    console.print(table)
    console.print(
        f"{len(cases) - len(wrong)} of {len(cases)} are right"
        + (f"; not {', '.join(wrong)}." if wrong else ".")
    )
    return 1 if wrong else 0


def _expected(case: Case | Hint) -> str:
    if isinstance(case, Hint):
        return f"more for {case.criterion}, and nothing less"
    if case.is_refused:
        return "refused"
    if case.criteria is not None:
        return f"loses only {', '.join(sorted(case.criteria)) or 'nothing'}"
    if case.loses is None:
        return f"at most {case.most:g}"
    losses = [
        f"{name} -{loss.least:g}…{min(loss.most, COMPONENTS[name]):g}" for name, loss in case.loses.items()
    ]
    bonus = [f"bonus {name}" for name in sorted(case.earns)] + [
        f"no bonus {name}" for name in sorted(case.lacks)
    ]
    return ", ".join([*(losses or ["full marks"]), *bonus])


def _given(one: Outcome) -> str:
    if one.grade is None:
        return f"refused: {one.refused}"
    grade = one.grade
    lost = [
        f"{name} -{part.max - part.points:g}"
        for name, part in grade.components.items()
        if part.points < part.max
    ]
    return f"{grade.total:g}" + (f" ({', '.join(lost)})" if lost else "")


if __name__ == "__main__":
    raise SystemExit(main())
