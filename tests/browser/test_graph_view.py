"""The picture of the ROS graph, as somebody sees it and reaches it with the keyboard."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from browsing import TIMEOUT_MS, Lab, Tab, choose_theme
from playwright.sync_api import Locator, expect

pytestmark = pytest.mark.long

NAME = "graph.ipynb"
CELLS = [
    "import rclpy\nfrom rclpy.context import Context\nfrom rclpy.node import Node\n"
    "from rclpy.qos import DurabilityPolicy, QoSProfile\nfrom std_msgs.msg import String\n"
    "from ros2lab import GraphView, LabSession",
    "session = LabSession()\nGraphView(session)",
    "class Talker(Node):\n"
    "    def __init__(self):\n"
    "        super().__init__('talker')\n"
    "        self.publisher = self.create_publisher(String, '/weather', 10)\n"
    "        self.create_timer(0.1, lambda: self.publisher.publish(String()))\n\n"
    "talker = session.run(Talker)",
    # A context of its own is, for the graph, another process.
    "context = Context()\nrclpy.init(context=context, domain_id=session.domain_id)\n"
    "late = Node('late_listener', context=context)\n"
    "kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n"
    "subscription = late.create_subscription(String, '/weather', print, kept)",
    "late.destroy_node()\ncontext.try_shutdown()\nsession.stop(talker)",
]


def run_cell(tab: Tab, number: int) -> None:
    """Run a cell and wait until it has its number."""
    cell = tab.page.locator(".jp-CodeCell").nth(number)
    cell.locator(".cm-content").press("Shift+Enter")
    prompt = cell.locator(".jp-InputPrompt")
    expect(prompt).to_have_text(re.compile(r"\[\d+\]:"), timeout=TIMEOUT_MS)


def part(tab: Tab, id: str) -> Locator:
    """Return a box or an arrow of the graph."""
    return tab.page.locator(f'.ros2lab-part[data-id="{id}"]')


def colour(locator: Locator, name: str) -> str:
    """Return a computed colour."""
    return str(locator.evaluate("(element, name) => getComputedStyle(element)[name]", name))


def test_the_graph_is_followed_explained_and_reached_by_keyboard(
    lab: Lab, open_tab: Callable[[str], Tab], pictures: Path | None
) -> None:
    """Nodes come and go, a QoS fault is drawn and explained, also in the dark and at 700 px."""
    lab.write(NAME, CELLS)
    tab = open_tab(NAME)
    card = tab.page.locator(".ros2lab-graph")
    details = card.locator(".ros2lab-details")

    run_cell(tab, 0)
    run_cell(tab, 1)
    expect(part(tab, "node /ros2lab")).to_be_visible(timeout=TIMEOUT_MS)
    expect(part(tab, "node /talker")).to_have_count(0)

    run_cell(tab, 2)
    expect(part(tab, "node /talker")).to_be_visible(timeout=TIMEOUT_MS)
    expect(part(tab, "topic /weather")).to_contain_text("nobody subscribes")
    expect(card.locator(".ros2lab-notes")).to_have_text("Nobody subscribes to /weather.")

    run_cell(tab, 3)
    arrow = part(tab, "/weather > /late_listener")
    expect(arrow).to_contain_text("QoS ≠", timeout=TIMEOUT_MS)
    expect(card.locator(".ros2lab-faults")).to_contain_text(
        "volatile publisher and transient local subscription"
    )
    assert "transient local" in (arrow.get_attribute("aria-label") or "")

    part(tab, "node /talker").focus()
    tab.page.keyboard.press("ArrowDown")
    expect(part(tab, "/talker > /weather")).to_be_focused()
    expect(details).to_contain_text("std_msgs/msg/String")
    expect(details).to_contain_text("transient local")
    expect(details.locator(".ros2lab-rate")).to_have_text(re.compile(r"^\d+\.\d Hz$"), timeout=TIMEOUT_MS)
    show(tab, pictures, "graph_light")

    ink = colour(card.locator(".ros2lab-label").first, "fill")
    choose_theme(tab, "JupyterLab Dark")
    assert colour(card.locator(".ros2lab-label").first, "fill") != ink
    show(tab, pictures, "graph_dark")

    tab.page.set_viewport_size({"width": 700, "height": 900})
    scroll = card.locator(".ros2lab-scroll")
    assert scroll.evaluate("element => element.scrollWidth <= element.clientWidth"), "all of it is seen"
    expect(arrow.locator(".ros2lab-badge")).to_be_visible()
    show(tab, pictures, "graph_700")

    run_cell(tab, 4)
    expect(part(tab, "node /talker")).to_have_count(0, timeout=TIMEOUT_MS)
    expect(part(tab, "node /late_listener")).to_have_count(0, timeout=TIMEOUT_MS)
    expect(card.locator(".ros2lab-faults li")).to_have_count(0)
    assert tab.complaints == []


@pytest.mark.thorough
def test_a_saved_graph_is_shown_without_its_kernel(lab: Lab, open_tab: Callable[[str], Tab]) -> None:
    """It is explained there, too, and what only a kernel can do is switched off."""
    lab.write(NAME, CELLS[:-1])
    tab = open_tab(NAME)
    tab.run_all(len(CELLS) - 1)
    expect(part(tab, "/weather > /late_listener")).to_contain_text("QoS ≠", timeout=TIMEOUT_MS)
    tab.save()
    assert tab.complaints == []
    tab.page.close()
    lab.end_kernels()

    again = open_tab(NAME)
    again.see_saved(".ros2lab-graph")
    card = again.page.locator(".ros2lab-graph")
    expect(card).to_contain_text("as it was when its kernel ended", timeout=TIMEOUT_MS)
    expect(part(again, "/weather > /late_listener")).to_contain_text("QoS ≠")
    part(again, "topic /weather").focus()
    expect(card.locator(".ros2lab-details")).to_contain_text("std_msgs/msg/String")
    for toggle in card.get_by_role("checkbox").all():
        expect(toggle).to_be_disabled()


def show(tab: Tab, pictures: Path | None, name: str) -> None:
    """Save a picture, if somebody wants it."""
    if pictures:
        tab.page.locator(".ros2lab-graph").scroll_into_view_if_needed()
        tab.page.screenshot(path=pictures / f"{name}.png")
