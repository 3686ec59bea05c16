"""A recording is looked at: its slider and its button move robot and plot, also when its kernel has gone."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from browsing import TIMEOUT_MS, Lab, Tab
from driving import trail_pixels, wait_for_picture
from playwright.sync_api import Locator, expect

pytestmark = pytest.mark.long

NAME = "a recording.ipynb"
CELLS = [
    "from geometry_msgs.msg import Twist\nfrom ros2lab import LabSession, RobotView, TwistPlot, read_recording",
    "import time\n"
    "session = LabSession()\n"
    "recorder = session.record('drive.mcap', topics='/cmd_vel')\n"
    "twist = Twist()\n"
    "for linear, angular in [(0.5, 1.0)] * 30 + [(1.0, -1.0)] * 20:\n"
    "    twist.linear.x, twist.angular.z = linear, angular\n"
    "    session.publish('/cmd_vel', twist)\n"
    "    time.sleep(0.1)\n"
    "recorder.stop()\n"
    "session.close()",
    "recording = read_recording('drive.mcap')\nRobotView(recording)",
    "TwistPlot(recording)",
]

SET_THEME = """async (theme) => {
  const token = new URLSearchParams(location.search).get('token') ?? '';
  const xsrf = document.cookie.match(/_xsrf=([^;]*)/)?.[1] ?? '';
  const answer = await fetch('/lab/api/settings/@jupyterlab/apputils-extension:themes', {
    method: 'PUT', headers: {'Content-Type': 'application/json', 'X-XSRFToken': xsrf},
    body: JSON.stringify({raw: JSON.stringify({theme})})});
  return answer.ok;
}"""


def cursor(plot: Locator) -> float:
    """Return how far to the right the plot's line stands, in px."""
    return float(plot.locator(".ros2lab-cursor").evaluate("cursor => cursor.getBoundingClientRect().x"))


def move_along(tab: Tab) -> None:
    """Move the slider by keys, and let the button move it; robot and plot show the same moment."""
    robot, plot = tab.page.locator(".ros2lab-robot"), tab.page.locator(".ros2lab-plot")
    slider, moment = robot.get_by_role("slider"), robot.locator("output")
    # Both are seen, for what nobody sees is not drawn.
    tab.page.set_viewport_size({"width": 1280, "height": 1500})
    slider.scroll_into_view_if_needed()
    whole = trail_pixels(tab)
    slider.focus()
    slider.press("Home")
    expect(moment).to_contain_text("0.00 s of")
    expect(plot.locator("output")).to_have_text(moment.inner_text())
    expect(robot.locator("[data-value=x]")).to_have_text("0.00")
    wait_for_picture(
        lambda: trail_pixels(tab) < whole - 100, "the trail is gone, but for the thin line of the whole way"
    )
    begin = cursor(plot)
    for _ in range(5):
        slider.press("PageUp")
    expect(plot.locator("[data-value=linear]")).to_have_text("0.50")
    expect(robot.locator("[data-value=heading]")).not_to_have_text("0")
    expect(robot.locator("[data-value=turning]")).to_have_text("1.00")
    assert cursor(plot) > begin + 100
    wait_for_picture(lambda: trail_pixels(tab) < whole, "a part of the trail is shown")
    plot.get_by_role("slider").press("End")
    expect(plot.locator("[data-value=linear]")).to_have_text("1.00")
    button = robot.get_by_role("button", name="Play")
    expect(robot.locator("[data-value=speed]")).to_have_text("1.00", timeout=TIMEOUT_MS)
    wait_for_picture(lambda: trail_pixels(tab) == pytest.approx(whole, abs=20), "the whole trail is back")
    button.press("Space")
    expect(robot.get_by_role("button", name="Pause")).to_be_visible()
    expect(robot.get_by_role("button", name="Play")).to_be_visible(timeout=TIMEOUT_MS)
    seconds, end = (np.array(moment.inner_text().replace(" s", "").split(" of "))).astype(float)
    assert seconds == end, "it has played to the end"


@pytest.mark.thorough
def test_a_recording_is_looked_at(lab: Lab, open_tab: Callable[..., Tab]) -> None:
    """In its notebook, and in the saved one without a kernel."""
    lab.write(NAME, CELLS)
    tab = open_tab(NAME)
    tab.run_all(len(CELLS))
    move_along(tab)
    tab.save()
    assert tab.complaints == []
    tab.page.close()
    lab.end_kernels()
    tab = open_tab(NAME)
    tab.see_saved(".ros2lab-robot")
    move_along(tab)
    expect(tab.page.get_by_text("Error displaying widget")).to_have_count(0)
    if folder := os.environ.get("PICTURES"):
        take_pictures(tab, Path(folder))


def take_pictures(tab: Tab, folder: Path) -> None:
    """Photograph both views, wide and narrow, light and dark."""
    for theme in ("JupyterLab Light", "JupyterLab Dark"):
        assert tab.page.evaluate(SET_THEME, theme)
        tab.page.reload()
        tab.page.locator(".ros2lab-plot output").wait_for(timeout=TIMEOUT_MS)
        if tab.page.locator("#jp-left-stack").is_visible():
            tab.page.keyboard.press("Control+b")  # without the files there is more room
        for width in (1280, 700):
            tab.page.set_viewport_size({"width": width, "height": 1150})
            tab.page.locator(".ros2lab-robot").get_by_role("slider").fill("2.5", timeout=TIMEOUT_MS)
            tab.page.locator(".ros2lab-robot").evaluate("robot => robot.scrollIntoView()")
            tab.page.wait_for_timeout(1500)
            tab.page.screenshot(path=folder / f"recorded_{theme.split()[-1].lower()}_{width}.png")
