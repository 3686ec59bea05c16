"""A student opens the notebook, runs it, and drives the robot with the mouse and the keyboard."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
from browsing import Stranger, Tab, number_of_code_cells
from film import film
from PIL import Image
from playwright.sync_api import Page, expect

NOTEBOOK = "08_drive_the_robot.ipynb"
STANDSTILL = [0.0, 0.0]
BLUE = (0, 114, 178)  # of linear x


def height_of_line(page: Page) -> int:
    """Return from the pixels of the plot how many rows lie between the line's lowest and highest point."""
    shot = Image.open(io.BytesIO(page.locator("svg.ros2lab-canvas").first.screenshot())).convert("RGB")
    distance = np.abs(np.asarray(shot).astype(int) - BLUE).sum(axis=2)
    rows = np.flatnonzero((distance < 60).any(axis=1))
    return int(rows.max() - rows.min()) if rows.size else 0


def press(tab: Tab, name: str) -> None:
    tab.page.locator(".ros2lab-panel").get_by_role("button", name=name).first.click()


def see_state(tab: Tab, state: str) -> None:
    expect(tab.page.locator(".ros2lab-panel").first).to_contain_text(state, timeout=20_000)


def drive(tab: Tab, stranger: Stranger) -> None:
    """Click every button and type a command; the stranger hears each and sees the robot answer."""
    press(tab, "start")
    stranger.wait_for("command", lambda word: word == "start")
    stranger.wait_for("velocity", lambda velocity: velocity[0] > 0)
    see_state(tab, "running")
    press(tab, "stop")
    stranger.wait_for("command", lambda word: word == "stop")
    stranger.wait_for("velocity", lambda velocity: velocity == STANDSTILL)
    see_state(tab, "stopped")
    press(tab, "reset")
    stranger.wait_for("command", lambda word: word == "reset")
    see_state(tab, "idle")
    type_quickly(tab, "Start", stranger)
    stranger.wait_for("velocity", lambda velocity: velocity[0] > 0)
    see_state(tab, "running")


def type_quickly(tab: Tab, word: str, stranger: Stranger) -> None:
    """Type a word faster than a kernel can keep up with, once with Enter and once with a click behind it."""
    field = tab.page.locator(".ros2lab-panel").get_by_role("textbox", name="other").first
    for send in (lambda: field.press("Enter"), lambda: press(tab, "send")):
        press(tab, "send")  # nothing
        field.press_sequentially(word)
        send()
        assert stranger.wait_for("command", lambda heard: heard[:1] in ("", word[0])) == word
        expect(field).to_have_value("")


def test_the_robot_is_driven_from_the_notebook(
    open_tab: Callable[..., Tab], stranger: Stranger, pictures: Path | None
) -> None:
    """Run all, drive, watch the plot, restart the kernel, close the tab and come back: all of it works."""
    cells = number_of_code_cells(NOTEBOOK)
    tab = open_tab(NOTEBOOK)
    tab.run_all(cells)
    tab.scroll_to(".ros2lab-panel")
    drive(tab, stranger)
    expect(tab.page.get_by_role("img", name="1.00 m/s").first).to_be_visible(timeout=20_000)
    assert height_of_line(tab.page) > 30, "the line stands at zero and, after the last command, above it"

    if pictures:
        film(tab, pictures)

    tab.restart_and_run_all(cells)
    drive(tab, stranger)

    address = tab.page.url
    tab.save()
    tab.page.close()
    again = Tab(tab.page.context.new_page())
    again.page.goto(address)
    again.wait_until_ready()
    again.scroll_to(".ros2lab-panel")
    drive(again, stranger)
    assert tab.complaints == []
    assert again.complaints == []
