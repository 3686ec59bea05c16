"""How long each lesson takes to run, its slowest cell, and what a cell of `%%terminal` costs."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any

import nbformat
from kernel import Kernel
from nbclient import NotebookClient
from place import Place, own_place
from row import Quantity, Row

from ros2lab import course

CELL_TIMEOUT = 300  # s
QUICK = "00_welcome"
TIMED = """
import time
def seconds(times):
    found = []
    for _ in range(times):
        begin = time.perf_counter()
        get_ipython().run_cell_magic("terminal", "", "true\\n")
        found.append(time.perf_counter() - begin)
    return found
"""


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Run every lesson once in a student's folder of its own, and many empty cells in a terminal."""
    chosen = [path for path in course.notebooks() if not is_quick or path.stem == QUICK]
    rows = []
    for number, path in enumerate(chosen):
        with own_place() as place:
            rows.append(_lesson(path, place))
        advance((number + 1) / (len(chosen) + 1))
    with own_place() as place:
        rows.append(_terminal(place, 10 if is_quick else 100))
    return rows


def _lesson(path: Path, place: Place) -> Row:
    notebook = nbformat.read(path, as_version=4)
    client = NotebookClient(notebook, timeout=CELL_TIMEOUT, store_widget_state=False)
    begin = time.perf_counter()
    client.execute(cwd=str(place.folder), env=place.environ)
    took = time.perf_counter() - begin
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    slowest = max(cells, key=_seconds)
    first = next(line for line in slowest.source.splitlines() if line.strip() and line[0] not in "#%")
    return Row(
        f"{path.stem}: all cells",
        Quantity(took, "s"),
        note=f"{len(cells)} cells; the slowest takes {_seconds(slowest):.1f} s: {first[:60]}",
    )


def _seconds(cell: Any) -> float:
    times = cell.metadata.get("execution", {})
    begin, end = times.get("iopub.execute_input"), times.get("shell.execute_reply")
    if not begin or not end:
        return 0.0
    return (datetime.fromisoformat(end[:26]) - datetime.fromisoformat(begin[:26])).total_seconds()


def _terminal(place: Place, times: int) -> Row:
    with Kernel(place.environ, place.folder) as kernel:
        kernel.run(f"%load_ext ros2lab.terminal\n{TIMED}")
        took = kernel.run("", f"seconds({times})")
    plain = []
    for _ in range(times):
        begin = time.perf_counter()
        subprocess.run(["bash", "-c", "true"], env=place.environ, check=True)
        plain.append(time.perf_counter() - begin)
    return Row(
        "a cell of %%terminal that does nothing",
        Quantity.of_samples([1000 * one for one in took[1:]], "ms"),
        "a plain subprocess of bash",
        Quantity.of_samples([1000 * one for one in plain[1:]], "ms"),
        note="the first one of each, which starts the terminal, is left out",
    )
