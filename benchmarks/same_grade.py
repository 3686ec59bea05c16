"""Whether a grade depends on what else the machine does: one submission again and again, while busy loops fill it."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from row import Quantity, Row

from grading import take_away_the_bonus
from ros2lab import course
from ros2lab.grading import rubric
from ros2lab.grading.collect import collect
from ros2lab.grading.reports.as_json import as_json
from ros2lab.grading.verdict import verdict

LOOPS = 4
TIMES, FEW_TIMES = 100, 3


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Count the different reports of three nodes without the bonus; the times in them aside."""
    times = FEW_TIMES if is_quick else TIMES
    chosen = rubric.load()
    reports = set()
    with tempfile.TemporaryDirectory(prefix="ros2lab-figures-") as name, _busy_machine():
        model = course.copy_reference(Path(name) / "model")
        take_away_the_bonus(model / "src/robot_controller")
        for number in range(times):
            report = json.loads(as_json(verdict(collect(model), chosen)))
            del report["seconds"], report["run"]
            reports.add(json.dumps(report, sort_keys=True))
            advance((number + 1) / times)
    return [
        Row(
            f"different reports of one submission, graded {times} times beside {LOOPS} busy loops",
            Quantity(len(reports), "report" if len(reports) == 1 else "reports"),
            limits={"value": 1.0},
        )
    ]


@contextmanager
def _busy_machine() -> Iterator[None]:
    with contextlib.ExitStack() as stack:
        for _ in range(LOOPS):
            loop = stack.enter_context(subprocess.Popen([sys.executable, "-c", "while True: pass"]))
            stack.callback(loop.kill)
        yield
