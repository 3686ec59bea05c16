"""Make each of `more_cases` for real, ask `ros2lab diagnose` about it, and print what its first answer is worth.

`make mistakes` calls it. With words, only the cases whose names hold one of them. `--of` asks other checkouts about
the same cases as well, and tells which became worse there. The exit code is 1 if a case could not be made or set right.

The first answer is that to what was seen; where that is unknown, the first one to the workspace.

right: the cause, its place, and a fix that applied literally sets it right
insufficient: the cause, but not the place, or a fix that is not enough
vague: true, and of no help
unknown: "not known here"
nothing: nothing was found, or what shows no error is called unknown
wrong: another cause, or a fix that does harm
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict
from pathlib import Path

from mistake_judging import Answer, Outcome, outcome
from more_cases import CASES, VERDICTS
from rich.console import Console
from rich.table import Table
from rich.text import Text

OWN = Path(__file__).resolve().parents[2]


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("words", nargs="*", help="parts of names")
    parser.add_argument(
        "--of", type=Path, action="append", default=[], help="another checkout that is asked, too"
    )
    parser.add_argument("--jobs", type=int, default=2, help="how many at a time")
    parser.add_argument("--without-fixes", action="store_true", help="do not try the cases' own fixes")
    parser.add_argument("--details", type=Path, help="a file for everything that was seen and said, in JSON")
    options = parser.parse_args()
    cases = [case for case in CASES if not options.words or any(word in case.name for word in options.words)]
    checkouts = [OWN, *(checkout.resolve() for checkout in options.of)]
    outcomes: dict[str, Outcome] = {}
    with ThreadPoolExecutor(options.jobs) as pool:
        running = [
            pool.submit(outcome, case, checkouts, with_fix=not options.without_fixes) for case in cases
        ]
        for number, future in enumerate(as_completed(running), 1):
            found = future.result()
            outcomes[found.name] = found
            verdicts = ", ".join(answer.verdict for answer in found.answers.values())
            print(
                f"[{number}/{len(cases)}] {found.name}: {found.problem or verdicts}",
                file=sys.stderr,
                flush=True,
            )
    ordered = [outcomes[case.name] for case in cases]
    if options.details:
        options.details.write_text(json.dumps([asdict(found) for found in ordered], indent=1))
    _show(ordered, [str(checkout) for checkout in checkouts])
    return 1 if any(found.problem and found.text for found in ordered) else 0


def worse(outcomes: Sequence[Outcome], before: str, after: str) -> list[str]:
    """Return the names of the cases of which `after` says something worse than `before` did."""
    rank = VERDICTS.index
    return [
        found.name
        for found in outcomes
        if found.answers and rank(found.answers[after].verdict) > rank(found.answers[before].verdict)
    ]


def _show(outcomes: Sequence[Outcome], checkouts: Sequence[str]) -> None:
    by_hand = {case.name: case.verdict for case in CASES}
    names = [Path(checkout).name for checkout in checkouts]
    console = Console() if sys.stdout.isatty() else Console(width=200)
    table = Table("case", "by hand", *names, "first answer", show_lines=True)
    for found in outcomes:
        answers = [found.answers.get(checkout) for checkout in checkouts]
        verdicts = [answer.verdict if answer else "-" for answer in answers]
        table.add_row(*map(Text, (found.name, by_hand[found.name], *verdicts, _said(found, names, answers))))
    console.print(table)
    asked = [found for found in outcomes if found.answers]
    columns = [
        Counter(by_hand[found.name] for found in asked),
        *(Counter(found.answers[checkout].verdict for found in asked) for checkout in checkouts),
    ]
    counts = Table("", "by hand", *names)
    for verdict in VERDICTS:
        counts.add_row(verdict, *(str(column[verdict]) for column in columns))
    console.print(counts)
    for checkout in checkouts[1:]:
        console.print(f"Worse in {checkout}: {', '.join(worse(asked, checkouts[0], checkout)) or 'none'}.")


def _said(found: Outcome, names: Sequence[str], answers: Sequence[Answer | None]) -> str:
    """Return what was said; by whom, if that differs."""
    said = [f"{answer.said or 'nothing'} ({answer.reason or 'as it is'})" for answer in answers if answer]
    if len(set(said)) > 1:
        said = [f"{name}: {text}" for name, text in zip(names, said, strict=True)]
    return "\n".join([*([found.problem] if found.problem else []), *dict.fromkeys(said)])


if __name__ == "__main__":
    raise SystemExit(main())
