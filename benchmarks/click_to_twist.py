"""From a real click in a real browser to the changed Twist at another process."""

from __future__ import annotations

import contextlib
import random
import statistics
import time
from collections.abc import Callable
from contextlib import ExitStack

from lesson import NOTEBOOK, code_cells
from opened_lab import opened_notebook
from place import own_place
from playwright.sync_api import Page
from program import Program
from row import Quantity, Row

WARM_UP = 10
LISTEN = """() => {
    window.clicks = [];
    const note = () => window.clicks.push(performance.timeOrigin + performance.now());
    document.addEventListener("click", note, { capture: true });
}"""


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Run lesson 8 in a browser and click start and stop by turns."""
    count, explained = (20, 10) if is_quick else (200, 50)
    with ExitStack() as stack:
        place = stack.enter_context(own_place())
        tab = stack.enter_context(opened_notebook(place, NOTEBOOK))
        tab.run_all(len(code_cells()))
        robot = stack.enter_context(Program("listener.py", "/cmd_vel", "Twist", environ=place.environ))
        robot.hear(lambda twist: twist["value"] == 0.0)
        tab.page.evaluate(LISTEN)
        ahead = _clock_ahead(tab.page)
        times = []
        for turn in range(-WARM_UP, count):
            clicked, twist = _click(tab.page, robot, turn % 2 == 0)
            if turn >= 0:
                times.append(twist["wall"] * 1000 - clicked + ahead)
                advance((turn + 1) / (count + explained))
        # Afterwards, so that one more listener does not slow down what is measured.
        words = stack.enter_context(Program("listener.py", "/robot/command", "String", environ=place.environ))
        _meet(tab.page, robot, words)
        firsts = []
        for turn in range(explained):
            clicked, _ = _click(tab.page, robot, turn % 2 == 0)
            firsts.append(words.hear()["wall"] * 1000 - clicked + ahead)
            advance((count + turn + 1) / (count + explained))
    return [
        Row(
            "click in JupyterLab → changed Twist at another process",
            Quantity.of_samples(times, "ms"),
            limits={"value": 10.0, "p99": 50.0},
            note=f"of which {statistics.median(firsts):.1f} ms until the command is heard at another process "
            f"({explained} clicks more)" + (f"; page's clock corrected by {ahead:.2f} ms" if ahead else ""),
        )
    ]


def _click(page: Page, robot: Program, is_start: bool) -> tuple[float, dict[str, float]]:
    """Click a button; return when the page saw it (ms of the page's wall clock) and the Twist it changed."""
    name, speed = ("start", 0.5) if is_start else ("stop", 0.0)
    time.sleep(random.uniform(0.05, 0.15))
    page.locator(".ros2lab-panel").first.get_by_role("button", name=name).click()
    twist = robot.hear(lambda twist: (twist["value"] > 0) == (speed > 0))
    return page.evaluate("window.clicks.at(-1)"), twist


def _meet(page: Page, robot: Program, words: Program) -> None:
    """Click start and stop until the listener to the commands hears them."""
    for _ in range(20):
        _click(page, robot, True)
        _click(page, robot, False)
        with contextlib.suppress(TimeoutError):
            words.hear(lambda word: word["value"] == "stop", timeout=1.0)
            return
    raise TimeoutError("The panel and the listener to its commands did not find each other.")


def _clock_ahead(page: Page) -> float:
    """Return by how many ms the page's clock is ahead of `time.time()`, as far as that can be known.

    Each answer came between asking and having it: 0 if that fits all answers, else the least that does.
    """
    least, most = float("-inf"), float("inf")
    for _ in range(50):
        asked = time.time() * 1000
        told = page.evaluate("performance.timeOrigin + performance.now()")
        answered = time.time() * 1000
        least, most = max(least, told - answered), min(most, told - asked)
    return min(max(0.0, least), most)
