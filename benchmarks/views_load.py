"""What robot, plot, graph and log cost together, kernel and browser, and how quickly a click moves the robot.

Beside them the robot alone as matplotlib draws it, and ipycanvas if it is installed: its extension would otherwise be
loaded by every JupyterLab that is tested. rqt and PlotJuggler come with an installed ROS only:
there is no package of them in Debian or on PyPI, so they are not compared.
"""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from importlib.util import find_spec

import psutil
from kernel import THREE_NODES
from load import processor_load
from opened_lab import opened_notebook
from place import Place, own_place
from playwright.sync_api import Page
from plot_load import kernel_pid, run_cell, write_notebook
from program import Program
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
# Likewise: a layer for what stands still, one for the trail, which only grows, and one for the robot.
IPYCANVAS = """
import math

from ipycanvas import MultiCanvas, hold_canvas

redraw_of(session).remove(draw)
layers = MultiCanvas(3, width=500, height=450)
ground, way, figure = layers
SCALE = 60
place = lambda x, y: (250 + SCALE * x, 350 - SCALE * y)
ground.stroke_style = "#ddd"
for number in range(-4, 6):
    ground.stroke_line(*place(number, -1), *place(number, 6))
    ground.stroke_line(*place(-4, number), *place(4, number))
way.stroke_style = figure.fill_style = "#0072b2"
way.line_width = 2
last = place(*robot.pose[:2])

def draw_on_canvas():
    global last
    x, y, heading = robot.pose
    here = place(x, y)
    with hold_canvas():
        way.stroke_line(*last, *here)
        figure.clear()
        figure.fill_circle(*here, 12)
        figure.stroke_line(*here, here[0] + 12 * math.cos(heading), here[1] - 12 * math.sin(heading))
    last = here

redraw_of(session).add(draw_on_canvas, 20.0)
layers
"""
COUNT = """
print("samples:", len({round(1e6 * sample.message.linear.x) for sample in robot.topic_logs[0].samples()} - {0, 500_000}))
"""
INPUT_RATE = 1000  # Hz
ALL_ON_SCREEN = 1800  # px, from the panel to the log: what is not seen costs nothing
SETTLE = 10.0  # s
FRAME_SECONDS = 10.0
MEET = 5.0  # s, in which another process that publishes is discovered
SHOWN = """() => document.querySelector(".ros2lab-robot") && document.querySelector(".ros2lab-graph")
    && document.querySelector(".ros2lab-plot") && document.querySelector(".ros2lab-scroller")"""
# The least that a browser can do twenty times a second: move a square.
SQUARE = """<div id="square" style="width:20px;height:20px;background:#0072b2;position:relative"></div><script>
    let step = 0;
    setInterval(() => (document.getElementById("square").style.left = `${step++ % 50}px`), 50);
</script>"""
# Notes when a click is seen, and when the robot of a frame that was drawn stands elsewhere than before.
WATCH = """() => {
    const body = document.querySelector(".ros2lab-robot .ros2lab-body");
    window.clicks = [];
    window.moves = [];
    window.drawn = 0;
    document.addEventListener("click", () => window.clicks.push(performance.now()), { capture: true });
    new MutationObserver(() => window.drawn++).observe(body, { attributes: true, attributeFilter: ["style"] });
    window.mover = new MutationObserver(() => requestAnimationFrame(() => window.moves.push(performance.now())));
    window.mover.observe(body, { attributes: true, attributeFilter: ["style"] });
}"""


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Drive with all views open in a real JupyterLab, click start and stop by turns, then let matplotlib draw."""
    seconds, settle, clicks = (5.0, 1.0, 10) if is_quick else (30.0, SETTLE, 200)
    with ExitStack() as stack:
        place = stack.enter_context(own_place())
        write_notebook(place.folder / "notebooks" / NAME, [THREE_NODES, VIEWS, COUNT, MATPLOTLIB, IPYCANVAS])
        tab = stack.enter_context(opened_notebook(place, NAME))
        tab.page.set_viewport_size({"width": 1280, "height": ALL_ON_SCREEN})
        run_cell(tab.page, 1)
        run_cell(tab.page, 2)
        tab.page.wait_for_function(SHOWN, timeout=120_000)
        tab.page.locator(".ros2lab-panel").scroll_into_view_if_needed()
        tab.page.evaluate(WATCH)
        times = []
        for turn in range(clicks):
            times.append(_click_until_it_moves(tab.page))
            advance(0.5 * (turn + 1) / clicks)
        _press(tab.page, "start")
        tab.page.evaluate("window.mover.disconnect()")  # it asks for a frame more for each that is drawn
        load = _Loads(tab.page, seconds, settle, advance)
        time.sleep(settle)
        frames = _frames_a_second(tab.page)
        kernel, browser = load.both(".ros2lab-panel", 0.5)
        samples, frames_at_1khz = _flood(tab.page, place)
        tab.page.locator(".jp-CodeCell").nth(2).locator(".cm-content").click()  # the panel has the keyboard
        run_cell(tab.page, 3)
        heard = _printed(tab.page, "samples: ")
        tab.page.set_viewport_size({"width": 1280, "height": 800})
        hidden_kernel, hidden_browser = load.both(".jp-CodeCell >> nth=-1", 0.6)
        run_cell(tab.page, 4)
        matplotlib = load.both(".jp-OutputArea-output img.widget-image, .widget-image", 0.7)
        ipycanvas = None
        if find_spec("ipycanvas"):
            run_cell(tab.page, 5)
            ipycanvas = load.both(".jp-CodeCell >> nth=4 >> canvas >> nth=0", 0.8)
        tab.page.goto("about:blank")
        tab.page.set_content(SQUARE)
        _, floor = load.both("#square", 0.9)
    peers = f"matplotlib's image: {matplotlib[1]:.1f} % in the browser"
    if ipycanvas:
        more = ipycanvas[0] - hidden_kernel
        peers += f"; ipycanvas: {more:.1f} % more in the kernel, {ipycanvas[1]:.1f} % in the browser"
    return [
        Row(
            "processor time of the kernel: three nodes, robot, plot, graph and log",
            Quantity(kernel, "% of a core"),
            "what matplotlib takes more to draw the robot alone, as an image",
            Quantity(matplotlib[0] - hidden_kernel, "% of a core"),
            {"value": 6.0},
            f"over {seconds:g} s each, at 20 frames a second; the robot alone with {peers}",
        ),
        Row(
            "processor time of the browser with them, which draws without a graphics card",
            Quantity(browser, "% of a core"),
            "a page in which a square of 20 pixels moves 20 times a second",
            Quantity(floor, "% of a core"),
            {"value": 15.0},
        ),
        Row(
            "processor time of kernel and browser, while the views are scrolled away",
            Quantity(hidden_kernel + hidden_browser, "% of a core"),
            "while they are seen",
            Quantity(kernel + browser, "% of a core"),
            note=f"{hidden_kernel:.1f} % in the kernel, which goes on driving; {hidden_browser:.1f} % in the browser",
        ),
        Row(
            f"commands that robot and plot miss at {INPUT_RATE / 1000:g} kHz",
            Quantity(samples - heard, "messages"),
            "sent by another process",
            Quantity(samples, "messages"),
            {"value": 0},
            f"{frames_at_1khz:.0f} frames a second meanwhile",
        ),
        Row("frames a second in which the robot moves", Quantity(frames, "Hz"), note="20 are asked for"),
        Row("click → moved robot on the screen", Quantity.of_samples(times, "ms")),
    ]


class _Loads:
    """Measures kernel and browser while something is on the screen, once it has settled."""

    def __init__(self, page: Page, seconds: float, settle: float, advance: Callable[[float], None]) -> None:
        self._page, self._seconds, self._settle, self._advance = page, seconds, settle, advance
        self._kernel = kernel_pid()

    def both(self, selector: str, done: float) -> tuple[float, float]:
        """Return the processor time in % of a core: of the kernel, and of the browser at the same time."""
        self._page.locator(selector).first.scroll_into_view_if_needed()
        processor_load([self._kernel], self._settle, lambda _: None)
        pids = _browser_pids()
        with ThreadPoolExecutor() as threads:
            browser = threads.submit(processor_load, pids, self._seconds, lambda _: None)
            kernel = processor_load(
                [self._kernel], self._seconds, lambda part: self._advance(done + 0.1 * part)
            )
            return kernel, browser.result()


def _flood(page: Page, place: Place) -> tuple[int, float]:
    """Command the robot a thousand times a second; return how many commands that were, and the frames a second."""
    count = round(INPUT_RATE * FRAME_SECONDS * 0.8)  # fewer than a log holds
    with Program("counter.py", "/cmd_vel", str(INPUT_RATE), "Twist", environ=place.environ) as sender:
        sender.tell(1)
        sender.hear()
        time.sleep(MEET)
        sender.tell(count)
        frames = _frames_a_second(page, count / INPUT_RATE)
        sender.hear(timeout=60)
        time.sleep(MEET)
    return count, frames


def _printed(page: Page, prefix: str) -> int:
    """Return the number that a cell has printed behind a text."""
    return int(page.get_by_text(prefix).last.inner_text().rpartition(prefix)[2])


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


def _frames_a_second(page: Page, seconds: float = FRAME_SECONDS) -> float:
    before = page.evaluate("window.drawn")
    begun = time.monotonic()
    page.wait_for_timeout(seconds * 1000)
    return float(page.evaluate("window.drawn") - before) / (time.monotonic() - begun)


def _browser_pids() -> list[int]:
    """Return the numbers of Chromium's processes below this one."""
    children = psutil.Process().children(recursive=True)
    return [process.pid for process in children if "chromium" in process.name()]
