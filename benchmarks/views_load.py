"""What robot, plot, graph and log cost together, kernel and browser, and how quickly a click moves the robot."""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from contextlib import ExitStack

import psutil
from kernel import THREE_NODES
from load import processor_load
from opened_lab import opened_notebook
from place import own_place
from playwright.sync_api import Page
from plot_load import kernel_pid, run_cell, write_notebook
from row import Quantity, Row

NAME = "views_load.ipynb"
VIEWS = """
from IPython.display import display
from ros2lab import CommandPanel, GraphView, NodeLog, RobotView, SideBySide, TwistPlot

robot = RobotView(session)
display(SideBySide(CommandPanel(session), robot), TwistPlot(session), GraphView(session), NodeLog(session))
"""
# As somebody who knows matplotlib would do it: figure and artists are made once, only the data change.
MATPLOTLIB = """
import io

import ipywidgets
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from ros2lab.widgets.redraw import redraw_of

figure = Figure(figsize=(5, 4.5))
canvas = FigureCanvasAgg(figure)
axes = figure.add_subplot(aspect="equal", xlim=(-4, 4), ylim=(-1, 6))
axes.grid()
(trail,) = axes.plot([], [])
(body,) = axes.plot([], [], "o", markersize=14)
image = ipywidgets.Image(format="png")
points = []

def draw():
    x, y, _ = robot.pose
    points.append((x, y))
    trail.set_data(*zip(*points))
    body.set_data([x], [y])
    buffer = io.BytesIO()
    canvas.print_png(buffer)
    image.value = buffer.getvalue()

redraw_of(session).add(draw, 20.0)
image
"""
SETTLE = 10.0  # s
FRAME_SECONDS = 10.0
SHOWN = """() => document.querySelector(".ros2lab-robot") && document.querySelector(".ros2lab-graph")
    && document.querySelector(".ros2lab-plot") && document.querySelector("table.ros2lab-log")"""
# The least that a browser can do twenty times a second: move a square.
SQUARE = """<div id="square" style="width:20px;height:20px;background:#0072b2;position:relative"></div><script>
    let step = 0;
    setInterval(() => (document.getElementById("square").style.left = `${step++ % 50}px`), 50);
</script>"""
# Notes when a click is seen, and when the robot of a frame that was drawn stands elsewhere than before.
WATCH = """() => {
    const body = document.querySelector(".ros2lab-robot [data-part=robots] g");
    window.clicks = [];
    window.moves = [];
    document.addEventListener("click", () => window.clicks.push(performance.now()), { capture: true });
    new MutationObserver(() => requestAnimationFrame(() => window.moves.push(performance.now())))
        .observe(body, { attributes: true, attributeFilter: ["transform"] });
}"""


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Drive with all views open in a real JupyterLab, click start and stop by turns, then let matplotlib draw."""
    seconds, settle, clicks = (5.0, 1.0, 10) if is_quick else (30.0, SETTLE, 200)
    with ExitStack() as stack:
        place = stack.enter_context(own_place())
        write_notebook(place.folder / "notebooks" / NAME, [THREE_NODES, VIEWS, MATPLOTLIB])
        tab = stack.enter_context(opened_notebook(place, NAME))
        run_cell(tab.page, 1)
        run_cell(tab.page, 2)
        tab.page.wait_for_function(SHOWN)
        tab.page.locator(".ros2lab-panel").scroll_into_view_if_needed()
        tab.page.evaluate(WATCH)
        times = []
        for turn in range(clicks):
            times.append(_click_until_it_moves(tab.page))
            advance(0.5 * (turn + 1) / clicks)
        _press(tab.page, "start")
        processor_load([kernel_pid()], settle, lambda _: None)
        frames = _frames_a_second(tab.page)
        kernel = processor_load([kernel_pid()], seconds, lambda part: advance(0.5 + 0.15 * part))
        browser = processor_load(_browser_pids(), seconds, lambda part: advance(0.65 + 0.15 * part))
        tab.page.locator(".jp-CodeCell").nth(2).locator(".cm-content").click()  # the panel has the keyboard
        run_cell(tab.page, 3)
        processor_load([kernel_pid()], settle, lambda _: None)
        both = processor_load([kernel_pid()], seconds, lambda part: advance(0.8 + 0.1 * part))
        tab.page.goto("about:blank")
        tab.page.set_content(SQUARE)
        processor_load([kernel_pid()], settle, lambda _: None)
        floor = processor_load(_browser_pids(), seconds, lambda part: advance(0.9 + 0.1 * part))
    return [
        Row(
            "processor time of the kernel: three nodes, robot, plot, graph and log",
            Quantity(kernel, "% of a core"),
            "what matplotlib takes more to draw the robot alone, as an image",
            Quantity(both - kernel, "% of a core"),
            {"value": 6.0},
            f"over {seconds:g} s each; {frames:.0f} frames a second are asked of both",
        ),
        Row(
            "processor time of the browser with them, which draws without a graphics card",
            Quantity(browser, "% of a core"),
            "a page in which a square of 20 pixels moves 20 times a second",
            Quantity(floor, "% of a core"),
            {"value": 15.0},
        ),
        Row("frames a second in which the robot moves", Quantity(frames, "Hz"), note="20 are asked for"),
        Row("click → moved robot on the screen", Quantity.of_samples(times, "ms")),
    ]


def _click_until_it_moves(page: Page) -> float:
    """Start the robot; return after how many ms it moved. It stands again afterwards."""
    begun = page.evaluate("window.moves.length")
    _press(page, "start")
    page.wait_for_function("begun => window.moves.length > begun + 1", arg=begun)
    seen = page.evaluate("begun => window.moves[begun] - window.clicks.at(-1)", begun)
    _press(page, "stop")
    page.wait_for_function("() => performance.now() - window.moves.at(-1) > 300")
    time.sleep(random.uniform(0.0, 0.1))
    return float(seen)


def _press(page: Page, name: str) -> None:
    page.locator(".ros2lab-panel").first.get_by_role("button", name=name).click()


def _frames_a_second(page: Page) -> float:
    before = page.evaluate("window.moves.length")
    begun = time.monotonic()
    page.wait_for_timeout(FRAME_SECONDS * 1000)
    return float(page.evaluate("window.moves.length") - before) / (time.monotonic() - begun)


def _browser_pids() -> list[int]:
    """Return the numbers of Chromium's processes below this one."""
    children = psutil.Process().children(recursive=True)
    return [process.pid for process in children if "chromium" in process.name()]
