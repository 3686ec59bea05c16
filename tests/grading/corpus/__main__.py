"""Grade the corpus, and print for each case as it is done: what it must get, what it got. `make corpus` calls it.

With words, only the cases whose names hold one of them. The exit code is 1 if a case did not get what it must, and
130 if Ctrl-C ended it; the last line then counts those that were done.
"""

from __future__ import annotations

import argparse
import os
import signal
import time

from corpus import CASES, HINTS
from corpus.case import COMPONENTS, Case
from corpus.graded import Outcome, each_graded
from corpus.hints import Hint


def main() -> int:
    parser = argparse.ArgumentParser(prog="make corpus", description=__doc__)
    parser.add_argument("words", nargs="*", help="parts of names")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="how many at a time")
    options = parser.parse_args()
    cases = {
        case.name: case
        for case in (*CASES, *HINTS)
        if not options.words or any(word in case.name for word in options.words)
    }
    began, wrong, done, code = time.monotonic(), [], 0, 0
    try:
        for done, (name, got) in enumerate(each_graded(cases, options.jobs), 1):
            left = (time.monotonic() - began) / done * (len(cases) - done) / 60
            print(f"{done}/{len(cases)}, {left:.0f} min left: {name} must get: {_expected(cases[name])}")
            print(f"    has got {_given(got)}: {'wrong' if got.problems else 'right'}", flush=True)
            wrong += [name] if got.problems else []
            for problem in got.problems:
                print(f"    {problem}", flush=True)
    except KeyboardInterrupt:
        code = 128 + signal.SIGINT
        print(f"Ended by Ctrl-C; {len(cases) - done} of {len(cases)} were not graded.")
    print(f"{done - len(wrong)} of {done} are right" + (f"; not {', '.join(wrong)}." if wrong else "."))
    return code or bool(wrong)


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
