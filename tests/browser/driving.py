"""The panel and the plot that drive the robot, as somebody sees and clicks them."""

from __future__ import annotations

import io

import numpy as np
from browsing import Tab
from PIL import Image
from playwright.sync_api import expect

TIMEOUT_MS = 20_000
BLUE = (0, 114, 178)  # of linear x


def press(tab: Tab, name: str) -> None:
    """Click a button of the panel."""
    tab.page.locator(".ros2lab-panel").get_by_role("button", name=name).first.click()


def see_state(tab: Tab, state: str) -> None:
    """Wait until the panel shows a state."""
    expect(tab.page.locator(".ros2lab-panel").first).to_contain_text(state, timeout=TIMEOUT_MS)


def see_speed(tab: Tab, speed: str) -> None:
    """Wait until the plot names a speed, and see in its pixels that the line has risen."""
    expect(tab.page.get_by_role("img", name=speed).first).to_be_visible(timeout=TIMEOUT_MS)
    assert height_of_line(tab) > 30, "the line stands at zero and, after the command, above it"


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
    assert trail_pixels(tab) > before + 30, "the trail has grown"


def trail_pixels(tab: Tab) -> int:
    """Return how many pixels of the plane have the robot's colour."""
    shot = tab.page.locator("svg.ros2lab-plane").first.screenshot()
    distance = np.abs(np.asarray(Image.open(io.BytesIO(shot)).convert("RGB")).astype(int) - BLUE).sum(axis=2)
    return int((distance < 60).sum())


def height_of_line(tab: Tab) -> int:
    """Return from the pixels of the plot how many rows lie between the line's lowest and highest point."""
    shot = tab.page.locator("svg.ros2lab-canvas").first.screenshot()
    distance = np.abs(np.asarray(Image.open(io.BytesIO(shot)).convert("RGB")).astype(int) - BLUE).sum(axis=2)
    rows = np.flatnonzero((distance < 60).any(axis=1))
    return int(rows.max() - rows.min()) if rows.size else 0
