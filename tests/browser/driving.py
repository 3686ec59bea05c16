"""The panel and the plot that drive the robot, as somebody sees and clicks them."""

from __future__ import annotations

import io
import time
from collections.abc import Callable

import numpy as np
from browsing import TIMEOUT_MS, Tab
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import expect

from deadlines import DEADLINE

BLUES = ((0, 114, 178), (86, 180, 233))  # of linear x and of the robot, in the light and in the dark theme


def press(tab: Tab, name: str) -> None:
    """Click a button of the panel."""
    tab.page.locator(".ros2lab-panel").get_by_role("button", name=name).first.click()


def see_state(tab: Tab, state: str) -> None:
    """Wait until the panel shows a state."""
    expect(tab.page.locator(".ros2lab-panel").first).to_contain_text(state, timeout=TIMEOUT_MS)


def show_the_whole_drive(tab: Tab) -> None:
    """Let the plot show as much time as it can, so that a step is still seen on a busy machine."""
    tab.page.locator(".ros2lab-plot").get_by_role("spinbutton").first.fill("120")  # s


def see_speed(tab: Tab, speed: str) -> None:
    """Wait until the plot names a speed, and its pixels show that the line has risen to it."""
    expect(tab.page.get_by_role("img", name=speed).first).to_be_visible(timeout=TIMEOUT_MS)
    wait_for_picture(
        lambda: height_of_line(tab) > 30, "the line stands at zero and, after the command, above it"
    )


def see_trail(tab: Tab) -> None:
    """Wait until the robot has driven, and see in the pixels of the plane that its trail grows."""
    speed = tab.page.locator(".ros2lab-robot [data-value=speed]").first
    expect(speed).to_have_text("0.50", timeout=TIMEOUT_MS)
    before = trail_pixels(tab)
    heading = tab.page.locator(".ros2lab-robot [data-value=heading]").first
    began = heading.inner_text()
    # A quarter of a circle: the trail is then longer than what a robot covers that has turned on the spot.
    tab.page.wait_for_function(
        "([element, began]) => Math.abs(parseInt(element.textContent.replace('\\u2212', '-')) - began) > 20",
        arg=[heading.element_handle(), int(began.replace("\u2212", "-"))],
        timeout=TIMEOUT_MS,
    )
    wait_for_picture(lambda: trail_pixels(tab) > before + 30, "the trail has grown")


def wait_for_picture(is_seen: Callable[[], bool], what: str) -> None:
    """Wait until the pixels show it: a picture is drawn after the numbers beside it, on a busy machine much later."""
    end = time.monotonic() + DEADLINE
    while not is_seen():
        assert time.monotonic() < end, what


def trail_pixels(tab: Tab) -> int:
    """Return how many pixels of the plane have the robot's colour."""
    return int(blue(tab, ".ros2lab-plane").sum())


def height_of_line(tab: Tab) -> int:
    """Return from the pixels of the plot how many rows lie between the line's lowest and highest point."""
    rows = np.flatnonzero(blue(tab, ".ros2lab-canvas").any(axis=1))
    return int(rows.max() - rows.min()) if rows.size else 0


def blue(tab: Tab, selector: str) -> NDArray[np.bool_]:
    """Return which pixels of the first such element are blue as it is meant here, as rows of columns."""
    shot = tab.page.locator(selector).first.screenshot()
    pixels = np.asarray(Image.open(io.BytesIO(shot)).convert("RGB")).astype(int)
    return np.any([np.abs(pixels - colour).sum(axis=2) < 60 for colour in BLUES], axis=0)
