"""A drive that was saved, and is opened when its kernel has gone."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import nbformat
import pytest
from browsing import TIMEOUT_MS, Lab, Tab, choose_theme
from driving import height_of_line, wait_for_picture
from playwright.sync_api import expect

from ros2lab.widget_state import WIDGET_STATE, WIDGET_VIEW

pytestmark = pytest.mark.long

# What has come must still be in the plot when it is saved, also on the busiest computer: its window is 120 s.
CELLS = [
    "from geometry_msgs.msg import Twist\n"
    "from ros2lab import CommandPanel, Dashboard, LabSession, NodeLog, RobotView, SideBySide, TwistPlot",
    "session = LabSession()\nplot = TwistPlot(session, window=120)",
    "SideBySide(CommandPanel(session), plot)",
    "robot = RobotView(session)\nrobot",
    "NodeLog(session)",
    "session.node.get_logger().info('a word in the log')\n"
    "twist = Twist()\n"
    "for step in range(30):\n"
    "    twist.linear.x = float(step % 2)\n"
    "    session.publish('/cmd_vel', twist)\n"
    "    plot.topic_log.wait_for(step + 1)",
    "import time\nwhile robot.pose.x < 0.5:\n    time.sleep(0.05)",
]
DASHBOARD_CELLS = [
    CELLS[0],
    "session = LabSession()\ndashboard = Dashboard(session)\nrobot, _, plot, *_ = dashboard.views\nplot.window = 120",
    "dashboard",
    *CELLS[-2:],
]
NAME = "a drive.ipynb"
# What of a dashboard lies outside of it or over something else, is cut off, or too pale or small to be read.
UNFIT = """(dashboard) => {
  const found = [], outer = dashboard.getBoundingClientRect();
  const name = (part) => `${part.tagName} ${part.className?.baseVal ?? part.className}`;
  const tiles = [...dashboard.querySelectorAll(".ros2lab-tiles > *")];
  const boxes = tiles.map((tile) => tile.getBoundingClientRect());
  for (const part of [dashboard, ...tiles, dashboard.closest(".jp-OutputArea-output"), dashboard.closest(".jp-WindowedPanel-outer")])
    if (part && part.scrollWidth > part.clientWidth + 1) found.push(`${name(part)} is ${part.scrollWidth} px wide in ${part.clientWidth}`);
  boxes.forEach((box, i) => {
    if (box.left < outer.left - 1 || box.right > outer.right + 1) found.push(`${name(tiles[i])} lies outside`);
    boxes.slice(i + 1).forEach((other, k) => {
      if (box.left < other.right - 1 && other.left < box.right - 1 && box.top < other.bottom - 1 && other.top < box.bottom - 1)
        found.push(`${name(tiles[i])} lies over ${name(tiles[i + 1 + k])}`);
    });
  });
  const pen = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  const rgba = (colour) => {
    pen.clearRect(0, 0, 1, 1);
    pen.fillStyle = colour;
    pen.fillRect(0, 0, 1, 1);
    return [...pen.getImageData(0, 0, 1, 1).data];
  };
  const light = (colour) => {
    const [r, g, b] = rgba(colour).slice(0, 3).map((c) => ((c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = (part) => {
    for (; part; part = part.parentElement) {
      const colour = getComputedStyle(part).backgroundColor;
      if (rgba(colour)[3] > 250) return colour;
    }
    return "white";
  };
  for (const part of dashboard.querySelectorAll(".ros2lab-card *")) {
    const own = [...part.childNodes].filter((node) => node.nodeType === 3).map((node) => node.data.trim()).join("");
    if (!own || part.closest("style, [disabled], svg") || !part.getClientRects().length) continue;
    const style = getComputedStyle(part), [a, b] = [light(style.color), light(ground(part))].sort((x, y) => y - x);
    const contrast = (a + 0.05) / (b + 0.05);
    if (contrast < 4.5) found.push(`${name(part)} “${own.slice(0, 20)}” has a contrast of ${contrast.toFixed(1)}`);
    if (parseFloat(style.fontSize) < 11) found.push(`${name(part)} “${own.slice(0, 20)}” is set in ${style.fontSize}`);
  }
  return found;
}"""
MOST_CHARACTERS = 250_000


def see_last_pictures(tab: Tab, place: str = ".ros2lab-plot") -> None:
    """Wait until panel, plot and log are shown as they were, with what had come until then."""
    tab.see_saved(place)
    plot = tab.page.locator(place)
    expect(plot.locator(".ros2lab-news")).to_have_text("as it was when its kernel ended", timeout=TIMEOUT_MS)
    expect(plot.get_by_role("img", name="linear x 1.00 m/s")).to_be_visible()
    wait_for_picture(lambda: height_of_line(tab) > 30, "the line goes up and down")
    expect(tab.page.locator(".ros2lab-robot .ros2lab-news")).to_have_text("as it was when its kernel ended")
    x = tab.page.locator(".ros2lab-robot [data-value=x]").inner_text()
    assert float(x.replace("\u2212", "-")) >= 0.3, "the robot stands where it was"
    expect(tab.page.locator(".ros2lab-panel")).to_contain_text("/robot/command")
    expect(tab.page.locator("table.ros2lab-log")).to_contain_text("a word in the log")
    expect(tab.page.get_by_text("Error displaying widget")).to_have_count(0)


def see_it_fits_half_a_panel(tab: Tab) -> None:
    """Show the notebook in both halves of the panel; the dashboards fit, and can be read in both themes."""
    tab.page.set_viewport_size({"width": 1280, "height": 800})
    tab.menu("File", "New View for Notebook")
    dashboards = tab.page.locator(".ros2lab-dashboard")
    expect(dashboards).to_have_count(2, timeout=TIMEOUT_MS)
    for name in ("JupyterLab Light", "JupyterLab Dark"):
        choose_theme(tab, name)
        for dashboard in dashboards.all():
            dashboard.scroll_into_view_if_needed()
            expect(dashboard.locator(".ros2lab-tiles > *")).to_have_count(5, timeout=TIMEOUT_MS)
            assert dashboard.evaluate(UNFIT) == []
        if folder := os.environ.get("PICTURES"):
            tab.page.screenshot(path=Path(folder) / f"half_a_panel_{name[-4:].strip()}.png")
    tab.page.locator(".jp-mod-current .lm-TabBar-tabCloseIcon").last.click()
    expect(dashboards).to_have_count(1)


@pytest.mark.thorough
def test_a_saved_dashboard_shows_its_pictures_without_its_kernel(
    lab: Lab, open_tab: Callable[..., Tab]
) -> None:
    """And what is stored for readers without widgets is one picture of all."""
    path = lab.write(NAME, DASHBOARD_CELLS)
    tab = open_tab(NAME)
    tab.run_all(len(DASHBOARD_CELLS))
    expect(tab.page.locator("table.ros2lab-log")).to_contain_text("a word in the log")
    see_it_fits_half_a_panel(tab)
    tab.save()
    tab.page.close()
    lab.end_kernels()
    outputs = nbformat.read(path, as_version=4).cells[2].outputs
    assert [set(output.data) for output in outputs] == [{"text/plain", "image/png", WIDGET_VIEW}]
    tab = open_tab(NAME)
    see_last_pictures(tab, ".ros2lab-place-plot")
    expect(tab.page.locator(".ros2lab-tiles > *")).to_have_count(5)
    expect(tab.page.locator(".ros2lab-dashboard")).to_contain_text("ROS domain")
    if folder := os.environ.get("PICTURES"):
        tab.page.screenshot(path=Path(folder) / "saved_dashboard.png")


@pytest.mark.thorough  # that its pictures are stored is asked in ros/test_widgets_in_notebook.py
@pytest.mark.parametrize("kernels", [1, 2])
def test_a_saved_drive_shows_its_pictures_without_its_kernel(
    lab: Lab, open_tab: Callable[..., Tab], kernels: int
) -> None:
    """Also after a second kernel has run it; and the file does not grow."""
    path = lab.write(NAME, CELLS)
    numbers_saved = []
    tab = open_tab(NAME)
    for _ in range(kernels):
        tab.run_all(len(CELLS))
        expect(tab.page.locator("table.ros2lab-log")).to_contain_text("a word in the log")
        tab.save()
        assert tab.complaints == []
        saved = nbformat.read(path, as_version=4)
        numbers_saved.append(len(saved.metadata.widgets[WIDGET_STATE].state))
        assert path.stat().st_size < MOST_CHARACTERS
        tab.page.close()
        lab.end_kernels()
        tab = open_tab(NAME)
        see_last_pictures(tab)
    assert numbers_saved[0] == numbers_saved[-1] > 0
    if folder := os.environ.get("PICTURES"):
        tab.page.screenshot(path=Path(folder) / "saved_drive.png")
