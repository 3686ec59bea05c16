"""Hold our `ros2` against the real one: the same commands, side by side.

FOLDER holds an executable `ros2` that runs the real tool (see docs). Each case runs with both in the same
prepared surroundings: a folder, a ROS domain, a built workspace and nodes that publish fixed things. Shown is
where standard output, standard error, the files left behind or the exit code differ after a few narrow
normalizations, and how long each took.

Without names all cases run, which takes about twenty minutes.
"""

from __future__ import annotations

import argparse
import fnmatch
import json
import shlex
import signal
import sys
import sysconfig
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from against_ros2cli_case import NORMALIZATIONS, Case, Comparison, Run
from against_ros2cli_cases import GROUPS
from against_ros2cli_place import WORLDS, Surroundings, surroundings
from against_ros2cli_run import run
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.syntax import Syntax
from rich.table import Table

PAPER_WIDTH = 120  # letters, where the table does not go to a terminal
OURS = Path(sysconfig.get_path("scripts"), "ros2")
COLOURS = {"same": "green", "intended": "cyan", "missing": "yellow", "differs": "red"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare what is named; return 0 if both are the same in all of it, or differ on purpose."""
    options = _parser().parse_args(arguments)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # a background job would hand down that it is ignored
    console = Console(stderr=True)
    cases = chosen(options.names)
    if options.list:
        print("\n".join(f"{group}\t{case.name}" for group, case in cases))
        return 0
    real = options.folder.resolve() / "ros2"
    for program, hint in ((real, "give the folder in which the real one runs"), (OURS, "run `make lab`")):
        if not program.is_file():
            console.print(f"There is no {program}: {hint}.", markup=False)
            return 2
    found: list[tuple[str, Comparison]] = []
    try:
        _compare(cases, real, options.runs, console, found)
        code = int(any(comparison.verdict in ("missing", "differs") for _, comparison in found))
    except KeyboardInterrupt:
        console.print("Interrupted: everything is stopped, and what was not yet compared is left out.")
        code = 130
    except (RuntimeError, TimeoutError) as error:
        console.print(f"{error} What was not yet compared is left out.", markup=False)
        code = 2
    _show(found)
    if options.markdown:
        options.markdown.write_text(markdown(found), encoding="utf-8")
    if options.json:
        data = [{"group": group, **comparison.as_data()} for group, comparison in found]
        options.json.write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return code


def chosen(names: Sequence[str]) -> list[tuple[str, Case]]:
    """Return the cases with their groups: those of the named groups, and those whose name fits a pattern."""
    return [
        (group, case)
        for group, cases in GROUPS.items()
        for case in cases
        if not names or any(_fits(name, group, case) for name in names)
    ]


def markdown(found: Sequence[tuple[str, Comparison]]) -> str:
    """Return counts, a table of what differs or is slow, and every difference."""
    lines = ["# Our `ros2` beside the real one", "", _summary(found), ""]
    lines += ["| group | same | intended | missing | differs | real | ours |", "| --- " * 7 + "|"]
    for group in dict.fromkeys(group for group, _ in found):
        members = [comparison for name, comparison in found if name == group]
        counts = Counter(comparison.verdict for comparison in members)
        times = [sum(member.seconds(side) for member in members) / len(members) for side in (True, False)]
        numbers = " | ".join(str(counts[verdict]) for verdict in COLOURS)
        lines.append(f"| {group} | {numbers} | {times[0]:.2f} s | {times[1]:.2f} s |")
    for verdict, heading in (
        ("differs", "Differs"),
        ("missing", "Missing"),
        ("intended", "Differs on purpose"),
    ):
        members = [comparison for _, comparison in found if comparison.verdict == verdict]
        lines += ["", f"## {heading} ({len(members)})"] if members else []
        for comparison in members:
            lines += ["", f"### `{comparison.case.name}`", ""]
            lines.append(
                f"{', '.join(comparison.differing)}; world {comparison.case.world}. {comparison.why}"
            )
            if verdict != "missing":
                lines += ["", "````diff", comparison.diff(), "````"]
    return "\n".join(lines) + "\n"


def _compare(
    cases: Sequence[tuple[str, Case]],
    real: Path,
    runs: int,
    console: Console,
    found: list[tuple[str, Comparison]],
) -> None:
    """Run case after case into `found`, world by world; the two sides by turns."""
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("prepare the surroundings", total=len(cases))
        with surroundings(real) as place:
            sides = (place.side_environ(real, "real"), place.side_environ(OURS, "ours"))
            prefixes = (place.ask_real("pkg", "prefix", "rclpy").strip(), sys.prefix)
            for world in WORLDS:
                members = [(group, case) for group, case in cases if case.world == world]
                if members:
                    place.enter(world)
                for group, case in members:
                    progress.update(task, description=case.name[:60])
                    real_runs, our_runs = _run_both(place, case, sides, runs)
                    found.append((group, Comparison(case, real_runs, our_runs, prefixes)))
                    progress.advance(task)


def _run_both(
    place: Surroundings, case: Case, sides: Sequence[dict[str, str]], runs: int
) -> tuple[list[Run], list[Run]]:
    results: tuple[list[Run], list[Run]] = ([], [])
    for _ in range(runs):
        for side, result in zip(sides, results, strict=True):
            place.clear()
            result.append(run(case, place.work, side))
    return results


def _show(found: Sequence[tuple[str, Comparison]]) -> None:
    """Print the differences, then the table."""
    output = Console() if sys.stdout.isatty() else Console(width=PAPER_WIDTH)
    for _, comparison in found:
        if comparison.verdict == "differs":
            output.print(f"\n[bold]{escape(comparison.case.name)}[/bold]")
            output.print(Syntax(comparison.diff(), "diff", background_color="default", word_wrap=True))
    table = Table(caption=_summary(found))
    for heading in ("group", "case", "verdict", "where", "real", "ours"):
        table.add_column(heading, justify="right" if heading in ("real", "ours") else "left")
    for group, comparison in found:
        verdict = comparison.verdict
        table.add_row(
            group,
            escape(comparison.case.name),
            f"[{COLOURS[verdict]}]{verdict}[/]",
            ", ".join(comparison.differing),
            *(f"{comparison.seconds(side):.2f} s" for side in (True, False)),
        )
    output.print(table)


def _summary(found: Sequence[tuple[str, Comparison]]) -> str:
    counts = Counter(comparison.verdict for _, comparison in found)
    return f"{len(found)} cases: " + ", ".join(f"{counts[verdict]} {verdict}" for verdict in COLOURS)


def _fits(name: str, group: str, case: Case) -> bool:
    if name in GROUPS:
        return name == group
    return case.name.startswith(name) or fnmatch.fnmatchcase(case.name, name)


def _parser() -> argparse.ArgumentParser:
    groups = "\n".join(f"  {name:12}{len(cases)} cases" for name, cases in GROUPS.items())
    parser = argparse.ArgumentParser(
        description=__doc__,
        epilog=f"groups:\n{groups}\n\nnormalizations: {', '.join(NORMALIZATIONS)}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="where the real `ros2` is")
    parser.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help="a group, how a command begins ("
        + shlex.quote("topic echo")
        + "), or a pattern with *; all if none",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write everything to a file, too")
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="write the differences to a file, too")
    parser.add_argument(
        "--runs", type=int, default=1, metavar="N", help="times are the median of so many (1)"
    )
    parser.add_argument("--list", action="store_true", help="show the cases, and run none")
    return parser


if __name__ == "__main__":
    sys.exit(main())
