"""How soon a student sees something in the first lesson, whose first cell imports what it needs."""

from __future__ import annotations

import time
from collections.abc import Callable

from opened_lab import opened_notebook
from place import own_place
from playwright.sync_api import Page
from row import Quantity, Row

NAME = "00_welcome.ipynb"
GREETING, ROBOT = 1, 2  # code cells, the first of which has an output; before them is the import
TIMEOUT_MS = 120_000


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Run the first cells in a kernel that has just started, again and again.

    Args:
        advance: is called with how much is done, from 0 to 1.
        is_quick: whether one kernel is enough.
    """
    count = 1 if is_quick else 5
    times = []
    for done in range(count):
        with own_place() as place, opened_notebook(place, NAME) as tab:
            times.append(_times(tab.page))
        advance((done + 1) / count)
    outputs, robots = zip(*times, strict=True)
    note = "a new kernel each time; the first cell imports"
    return [
        Row(
            "first cell of lesson 0 → first output",
            Quantity.of_samples(outputs, "s"),
            limits={"value": 2.0},
            note=note,
        ),
        Row("first cell of lesson 0 → the robot is there", Quantity.of_samples(robots, "s"), note=note),
    ]


def _times(page: Page) -> tuple[float, float]:
    """Run the cells one after the other; return the times in s until the greeting and until the robot."""
    cells = page.locator(".jp-CodeCell")
    page.keyboard.press("Escape")
    cells.first.locator(".cm-content").click()
    begin = time.perf_counter()
    for number in range(ROBOT + 1):
        cells.nth(number).locator(".cm-content").press("Shift+Enter")
    cells.nth(GREETING).locator(".jp-OutputArea-output").first.wait_for(timeout=TIMEOUT_MS)
    greeting = time.perf_counter() - begin
    page.locator("svg.ros2lab-plane").first.wait_for(timeout=TIMEOUT_MS)
    return greeting, time.perf_counter() - begin
