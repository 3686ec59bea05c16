"""Measure the lab and print one table: what, beside what, measured, ratio, target, met or not.

Without names everything is measured, which takes about half an hour. It needs what `make test` installs.
A machine that does other things meanwhile gives other figures: the load is printed with them.
"""

from __future__ import annotations

import argparse
import importlib
import json
import logging
import os
import platform
import signal
import sys
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path

import psutil
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from row import Row

PAPER_WIDTH = 120  # letters, where the table does not go to a terminal

# Each is a module with `measure(advance, is_quick)`, or another function of it that is named, which returns rows.
FIGURES = {
    "command_to_twist": "kernel command → changed Twist at another process, against a bare rclpy hop",
    "first_output": "first cell of lesson 0 → first output, and → the robot",
    "click_to_twist": "click in a browser → changed Twist at another process",
    "plot_load": "the kernel's processor time with a live plot, against matplotlib's",
    "views_load": "robot, plot, graph and log together: kernel, browser, frames, and click → moved robot",
    "log_at_1khz": "messages that a TopicLog misses at 1 kHz",
    "kernel_memory": "memory of a kernel with everything, against a bare one",
    "ros2_command": "the portable ros2 command: times, and complete answers on ten new nodes",
    "lessons": "how long each lesson takes, its slowest cell, and what a cell of %%terminal costs",
    "slips_undone": "slips of typing in right packages, and how many are undone to the letter",
    "grading": "what a grade costs, beside nbgrader's (needs bubblewrap)",
    "same_grade": "whether a grade under load is the same 100 times (takes 20 minutes; needs bubblewrap)",
    "class_grading.rate": "a class of 60 as many at once as the machine bears, beside one at a time (10 minutes; needs bubblewrap)",
    "class_grading.beside_nbgrader": "twelve submissions, beside nbgrader's autograde (needs bubblewrap)",
    "class_grading.sizes": "rate and memory of a class of 10 and of 60 (needs bubblewrap)",
    "class_grading.large": "rate and memory of a class of 120 (10 minutes; needs bubblewrap)",
    "class_grading.tiny": "rate and memory of 500 in which nothing runs (needs bubblewrap)",
    "class_grading.on_workers": "twelve submissions on one, two and three workers (needs bubblewrap)",
    "class_grading.going_on": "how soon a class goes on after kill -9 (needs bubblewrap)",
    "class_on_a_server": "a class on one server: memory, processor, clicks (needs root, the internet, half an hour)",
    "make_lab": "`make lab` from nothing and again, against pip (needs the internet)",
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure what is named; return 0 if everything was measured, whether the targets are met or not."""
    options = _parser().parse_args(arguments)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    console = Console(stderr=True)
    rows: list[Row] = []
    failed: list[str] = []
    before = os.getloadavg()[0]
    try:
        _measure(options.names or list(FIGURES), options.quick, console, rows, failed)
        code = 1 if failed else 0
    except KeyboardInterrupt:
        logging.getLogger("asyncio").disabled = True  # where Playwright mourns what it was interrupted in
        console.print("Interrupted: everything is stopped, and what was not yet measured is left out.")
        code = 130
    if rows:
        output = Console() if sys.stdout.isatty() else Console(width=PAPER_WIDTH)
        output.print(table(rows, caption=f"{machine()}; load when it began {before:.1f}"))
    if options.json:
        data = {"machine": machine(), "load": before, "rows": [row.as_data() for row in rows]}
        options.json.write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return code


def table(rows: Sequence[Row], caption: str = "") -> Table:
    """Return the rows as a table of text."""
    result = Table(caption=caption, show_lines=True)
    for heading in ("what", "measured", "floor or peer", "ratio", "target", "met"):
        result.add_column(heading)
    for row in rows:
        what = f"{row.what}\n[dim]{row.note}[/dim]" if row.note else row.what
        peer = f"{row.peer}\n[dim]{row.peer_name}[/dim]" if row.peer else row.peer_name
        ratio = "" if row.ratio is None else f"{row.ratio:.2g}"
        met = {True: "[green]yes[/green]", False: "[red]no[/red]", None: ""}[row.is_met]
        result.add_row(what, str(row.measured), peer, ratio, row.target, met)
    return result


def machine() -> str:
    """Say on what was measured."""
    models = [
        line.partition(":")[2].strip()
        for line in Path("/proc/cpuinfo").read_text().splitlines()
        if line.startswith("model name")
    ]
    memory = psutil.virtual_memory().total / 2**30
    model = models[0] if models else platform.machine()
    return f"{len(models)} cores, {model}, {memory:.0f} GB, Python {platform.python_version()}"


def _measure(
    names: Sequence[str], is_quick: bool, console: Console, rows: list[Row], failed: list[str]
) -> None:
    """Measure one after the other into `rows`; one that fails does not keep the others from it."""
    columns = TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn()
    with Progress(*columns, console=console) as progress:
        for name in names:
            task = progress.add_task(name, total=1.0)
            module, _, function = name.partition(".")
            measure: Callable[..., list[Row]] = getattr(
                importlib.import_module(module), function or "measure"
            )
            try:
                rows += measure(
                    lambda done, task=task: progress.update(task, completed=done), is_quick=is_quick
                )
                progress.update(task, completed=1.0)
            except Exception:
                failed.append(name)
                console.print(f"{name} could not be measured:\n{traceback.format_exc()}", markup=False)
            finally:
                progress.stop_task(task)


def _parser() -> argparse.ArgumentParser:
    names = "\n".join(f"  {name:31}{text}" for name, text in FIGURES.items())
    parser = argparse.ArgumentParser(
        description=__doc__, epilog=f"figures:\n{names}", formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "names", nargs="*", metavar="NAME", choices=[*FIGURES, []], help="a figure; all if none is named"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the rows to a file, too")
    parser.add_argument(
        "--quick", action="store_true", help="fewer samples: to see that it works, not for figures"
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
