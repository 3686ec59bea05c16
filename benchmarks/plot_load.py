"""What a live plot costs the kernel, in a real JupyterLab in a real browser; and what matplotlib would."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import nbformat
import psutil
from kernel import THREE_NODES
from load import processor_load
from nbformat.v4 import new_code_cell, new_notebook
from opened_lab import opened_notebook
from place import own_place
from playwright.sync_api import Page
from row import Quantity, Row

NAME = "plot_load.ipynb"
DRIVE = """
session.publish("/robot/command", "start")
"""
PLOT = """
from ros2lab import TwistPlot

plot = TwistPlot(session)
plot
"""
# As somebody who knows matplotlib would do it: figure and lines are made once, only the data change.
MATPLOTLIB = """
import io
import time

import ipywidgets
from geometry_msgs.msg import Twist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from ros2lab.widgets.redraw import redraw_of

plot.close()
log = session.log("/cmd_vel", Twist)
figure = Figure(figsize=(8, 3))
canvas = FigureCanvasAgg(figure)
panels = figure.subplots(2, sharex=True)
lines = [axes.plot([], [])[0] for axes in panels]
for axes, name in zip(panels, ("linear x (m/s)", "angular z (rad/s)")):
    axes.set_ylabel(name)
    axes.set_ylim(-0.1, 0.6)
    axes.grid()
image = ipywidgets.Image(format="png")

def draw():
    now = time.monotonic()
    samples = log.samples(since=now - 10)
    times = [sample.time - now for sample in samples]
    lines[0].set_data(times, [sample.message.linear.x for sample in samples])
    lines[1].set_data(times, [sample.message.angular.z for sample in samples])
    panels[0].set_xlim(-10, 0)
    buffer = io.BytesIO()
    canvas.print_png(buffer)
    image.value = buffer.getvalue()

redraw_of(session).add(draw, 10.0)
image
"""
SETTLE = 12.0  # s, until ten seconds of data are shown
LIVE = """() => /Hz/.test(document.querySelector(".ros2lab-plot .ros2lab-news")?.textContent)"""
NEW_IMAGE = """() => {
    const source = document.querySelector("img.jupyter-widgets, .jupyter-widgets img, img.widget-image")?.src;
    window.firstSource ??= source;
    return source && source !== window.firstSource;
}"""


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Run a notebook of three steps, and measure its kernel after each."""
    seconds, settle = (5.0, 1.0) if is_quick else (30.0, SETTLE)
    steps = ((DRIVE, None), (PLOT, LIVE), (MATPLOTLIB, NEW_IMAGE))
    loads = []
    with ExitStack() as stack:
        place = stack.enter_context(own_place())
        write_notebook(place.folder / "notebooks" / NAME, [THREE_NODES, *(code for code, _ in steps)])
        tab = stack.enter_context(opened_notebook(place, NAME))
        run_cell(tab.page, 1)
        for number, (_, is_shown) in enumerate(steps):
            run_cell(tab.page, number + 2)
            if is_shown:
                tab.page.wait_for_function(is_shown)

            def go_on(part: float, done: int = number) -> None:
                advance((done + part) / len(steps))

            processor_load([kernel_pid()], settle, lambda _: None)
            loads.append(processor_load([kernel_pid()], seconds, go_on))
    nodes, plot, matplotlib = loads
    return [
        Row(
            "processor time of the kernel: three nodes and a live plot at 10 Hz",
            Quantity(plot, "% of a core"),
            "matplotlib drawing it as an image, in the same kernel",
            Quantity(matplotlib, "% of a core"),
            {"value": 5.0},
            f"of which the three nodes take {nodes:.1f} % without a plot; over {seconds:g} s each",
        )
    ]


def write_notebook(path: Path, cells: list[str]) -> None:
    """Write a notebook of code cells."""
    notebook = new_notebook(cells=[new_code_cell(cell.strip()) for cell in cells])
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    path.parent.mkdir(parents=True)
    nbformat.write(notebook, path)


def run_cell(page: Page, number: int) -> None:
    """Run the selected cell, which is the `number`th, and wait for its end."""
    page.keyboard.press("Shift+Enter")
    page.wait_for_function(
        """number => [...document.querySelectorAll(".jp-CodeCell .jp-InputPrompt")]
            .some(prompt => prompt.textContent.includes(`[${number}]`))""",
        arg=number,
        timeout=60_000,
    )


def kernel_pid() -> int:
    """Return the number of the one kernel below this process."""
    for process in psutil.Process().children(recursive=True):
        if "ipykernel_launcher" in process.cmdline():
            return process.pid
    raise RuntimeError("JupyterLab has no kernel.")
