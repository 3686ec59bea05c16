"""A drive that was saved, and is opened when its kernel has gone."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import nbformat
from browsing import Lab, Tab
from playwright.sync_api import expect

from ros2lab.widget_state import WIDGET_STATE, WIDGET_VIEW

CELLS = [
    "from geometry_msgs.msg import Twist\n"
    "from ros2lab import CommandPanel, Dashboard, LabSession, NodeLog, RobotView, SideBySide, TwistPlot",
    "session = LabSession()\nplot = TwistPlot(session)",
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
    "session = LabSession()\ndashboard = Dashboard(session)\nrobot, _, plot, *_ = dashboard.views",
    "dashboard",
    *CELLS[-2:],
]
NAME = "a drive.ipynb"
MOST_CHARACTERS = 200_000


def see_last_pictures(tab: Tab, place: str = ".ros2lab-plot") -> None:
    """Wait until panel, plot and log are shown as they were, with what had come until then."""
    plot = tab.page.locator(place)
    expect(plot.locator(".ros2lab-news")).to_have_text("as it was when its kernel ended", timeout=120_000)
    line = plot.locator("svg.ros2lab-canvas path.ros2lab-linear")
    assert (line.get_attribute("d") or "").count("V") > 10, "the line goes up and down"
    expect(tab.page.locator(".ros2lab-robot .ros2lab-news")).to_have_text("as it was when its kernel ended")
    x = tab.page.locator(".ros2lab-robot [data-value=x]").inner_text()
    assert float(x.replace("\u2212", "-")) >= 0.3, "the robot stands where it was"
    expect(tab.page.locator(".ros2lab-panel")).to_contain_text("/robot/command")
    expect(tab.page.locator("table.ros2lab-log")).to_contain_text("a word in the log")
    expect(tab.page.get_by_text("Error displaying widget")).to_have_count(0)


def test_a_saved_dashboard_shows_its_pictures_without_its_kernel(
    lab: Lab, open_tab: Callable[..., Tab]
) -> None:
    """And what is stored for readers without widgets is one picture of all."""
    path = lab.write(NAME, DASHBOARD_CELLS)
    tab = open_tab(NAME)
    tab.run_all(len(DASHBOARD_CELLS))
    expect(tab.page.locator("table.ros2lab-log")).to_contain_text("a word in the log")
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


def test_a_saved_drive_shows_its_pictures_without_its_kernel(lab: Lab, open_tab: Callable[..., Tab]) -> None:
    """Also after a second kernel has run it; and the file does not grow."""
    path = lab.write(NAME, CELLS)
    numbers_saved = []
    tab = open_tab(NAME)
    for _ in range(2):
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
    assert numbers_saved[0] == numbers_saved[1] > 0
    if folder := os.environ.get("PICTURES"):
        tab.page.screenshot(path=Path(folder) / "saved_drive.png")
