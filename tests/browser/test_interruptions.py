"""What interrupts a drive: a line that is cut, a second tab, and a kernel that is killed or shut down."""

from __future__ import annotations

import os
import re
import signal
from collections.abc import Callable

import pytest
from browsing import TIMEOUT_MS, Lab, Tab
from cutting import line_to
from driving import press, see_state
from playwright.sync_api import Locator, expect

pytestmark = pytest.mark.long

NAME = "interrupted drive.ipynb"
CELLS = [
    "import os\nfrom ros2lab import CommandPanel, GraphView, LabSession, NodeLog, RobotView, SideBySide, TwistPlot, course",
    "session = LabSession()\nfor node_class in course.reference_nodes():\n    session.run(node_class)",
    "SideBySide(CommandPanel(session), RobotView(session))",
    "TwistPlot(session)",
    "GraphView(session)",
    "NodeLog(session)",
    "os.getpid()",
]
ENDED = "as it was when its kernel ended"
# What the browser says of a line that is cut, and JupyterLab of what was on its way to a kernel that has gone: the next
# kernel gets it, and answers that it does not know the widget.
OF_THE_LINE = re.compile(r"net::ERR_|WebSocket connection to|Canceled future for|Comm not found for")


def heading(tab: Tab) -> Locator:
    """Return where the robot's heading stands."""
    return tab.page.locator(".ros2lab-robot [data-value=heading]").first


def see_driving(tab: Tab) -> None:
    """Wait until the robot turns and the plot receives something."""
    expect(heading(tab)).not_to_have_text(heading(tab).inner_text(), timeout=TIMEOUT_MS)
    expect(tab.page.locator(".ros2lab-plot .ros2lab-news")).to_have_text(
        re.compile(r"^\d+\.\d Hz$"), timeout=TIMEOUT_MS
    )


def see_the_end(tab: Tab) -> None:
    """Wait until all views say that they are no longer live, and see that nothing in them can be clicked."""
    for card in ("robot", "plot", "graph"):
        tab.scroll_to(f".ros2lab-{card}")  # what nobody sees is not drawn
        news = tab.page.locator(f".ros2lab-{card} .ros2lab-news")
        expect(news).to_have_text(re.compile(f"{ENDED}$"), timeout=TIMEOUT_MS)
    for card in ("panel", "node-log"):
        place = tab.page.locator(f".ros2lab-{card}")
        expect(place).to_have_class(re.compile("jupyter-widgets-disconnected"), timeout=TIMEOUT_MS)
        words = place.evaluate("(element) => getComputedStyle(element, '::before').content")
        assert ENDED in words, card
    for button in tab.page.locator(".ros2lab-panel").get_by_role("button").all():
        expect(button).to_be_disabled()


def kernel_number(tab: Tab) -> int:
    """Return the number of the kernel's process, which the last cell shows."""
    return int(tab.page.locator(".jp-CodeCell").last.locator(".jp-OutputArea-output").inner_text())


@pytest.mark.thorough
def test_a_drive_goes_on_after_what_interrupts_it(lab: Lab, open_tab: Callable[..., Tab]) -> None:
    """A cut line and a second tab change nothing; without a kernel all views say so, until the cells run again."""
    lab.write(NAME, CELLS)
    with line_to(lab) as (distant, line):
        tab = open_tab(NAME, lab=distant)
        tab.run_all(len(CELLS))
        press(tab, "start")
        see_driving(tab)
        with tab.page.expect_websocket(lambda socket: "/channels" in socket.url, timeout=TIMEOUT_MS):
            line.cut()
        see_driving(tab)
        press(tab, "stop")
        see_state(tab, "stopped")
        tab.save()

        other = open_tab(NAME)
        other.scroll_to(".ros2lab-panel")  # which comes from the kernel
        see_state(other, "stopped")
        press(other, "start")
        for page in (tab, other):
            see_state(page, "running")
            see_driving(page)

        os.kill(kernel_number(tab), signal.SIGKILL)
        for page in (tab, other):
            see_the_end(page)
        stopped_at = heading(tab).inner_text()
        other.page.close()
        tab.page.get_by_role("dialog").get_by_role("button", name="Ok").click()
        tab.wait_until_ready()
        assert heading(tab).inner_text() == stopped_at
        tab.run_all(len(CELLS))
        press(tab, "start")
        see_driving(tab)

        tab.menu("Kernel", "Shut Down Kernel")
        see_the_end(tab)
        tab.save()
        assert [text for text in (*tab.complaints, *other.complaints) if not OF_THE_LINE.search(text)] == []
    assert lab.log is not None
    assert "Traceback" not in lab.log.read_text()
