"""The robot is driven from a notebook: every way to send a command, a restarted kernel, and a page opened again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from browsing import Lab, Stranger, Tab
from driving import press, see_speed, see_state, see_trail, show_the_whole_drive
from film import film
from playwright.sync_api import expect

pytestmark = pytest.mark.long

NAME = "drive.ipynb"
CELLS = [
    "from ros2lab import CommandPanel, LabSession, RobotView, SideBySide, TwistPlot, course",
    "workspace = course.own_workspace()\nworkspace.build(show=False)\nworkspace.source()",
    "from robot_controller.command_subscriber import CommandSubscriber\n"
    "from robot_controller.status_publisher import StatusPublisher\n"
    "from robot_controller.velocity_publisher import VelocityPublisher",
    "session = LabSession()\n"
    "for node_class in (CommandSubscriber, StatusPublisher, VelocityPublisher):\n"
    "    session.run(node_class)",
    # A command goes to those that the graph shows; a node and the stranger are to hear it.
    "import time\nwhile session.node.count_subscribers('/robot/command') < 2:\n    time.sleep(0.05)",
    "SideBySide(CommandPanel(session), RobotView(session))",
    "TwistPlot(session)",
]
STANDSTILL = [0.0, 0.0]


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
    lab: Lab, open_tab: Callable[[str], Tab], stranger: Stranger, pictures: Path | None
) -> None:
    """Run all, and drive: each click and word arrives."""
    lab.write(NAME, CELLS)
    tab = open_tab(NAME)
    tab.run_all(len(CELLS))
    show_the_whole_drive(tab)
    tab.scroll_to(".ros2lab-panel")
    drive(tab, stranger)
    see_trail(tab)
    tab.scroll_to(".ros2lab-plot")
    see_speed(tab, "0.50 m/s")
    tab.scroll_to(".ros2lab-panel")
    if pictures:
        film(tab, pictures)
    assert tab.complaints == []


@pytest.mark.thorough
def test_the_robot_is_driven_on_after_its_page_was_closed(
    lab: Lab, open_tab: Callable[[str], Tab], stranger: Stranger
) -> None:
    lab.write(NAME, CELLS)
    tab = open_tab(NAME)
    tab.run_all(len(CELLS))
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


@pytest.mark.thorough
def test_the_robot_is_driven_after_a_restart(
    lab: Lab, open_tab: Callable[[str], Tab], stranger: Stranger
) -> None:
    lab.write(NAME, CELLS)
    tab = open_tab(NAME)
    tab.run_all(len(CELLS))
    tab.restart_and_run_all(len(CELLS))
    tab.scroll_to(".ros2lab-panel")
    drive(tab, stranger)
    see_trail(tab)
    assert tab.complaints == []
