"""Names and texts of somebody else's nodes are shown as text in every view, and nothing of them runs."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from browsing import TIMEOUT_MS, Lab, Tab
from playwright.sync_api import expect

pytestmark = pytest.mark.long

RUN = "(window.ran = window.ran || []).push"
MARK = "who-is-this"
# Ends each kind of element and attribute, is a formula with a link, moves a terminal's cursor, turns the direction of
# writing, and is as long as DDS takes it.
HOSTILE = (
    f"{MARK}\"'></text></pre></svg><script>{RUN}(1)</script><img src=x onerror='{RUN}(2)'><svg onload={RUN}(3)>"
    f"$\\href{{javascript:{RUN}(4)}}{{x}}$[x](javascript:{RUN}(5))\x1b]8;;x\x07\x9b2J\x00\u202e\u2028"
).ljust(255, "ü")
CELLS = [
    "from types import SimpleNamespace\nfrom rclpy.node import Node\nfrom rclpy.qos import DurabilityPolicy, QoSProfile\n"
    "from rcl_interfaces.msg import Log\nfrom std_msgs.msg import String\n"
    "from ros2lab import CommandPanel, Dashboard, GraphView, LabSession, NodeLog, TopicLog, TopicMonitor\n"
    f"HOSTILE = {HOSTILE!r}",
    # rcl lets nobody have such a name; who speaks DDS without it can.
    "end = SimpleNamespace(node_name=HOSTILE, node_namespace='/', topic_type=HOSTILE, qos_profile=QoSProfile(depth=1))\n"
    "class Known(Node):\n"
    "    def get_node_names_and_namespaces(self):\n"
    "        return [*super().get_node_names_and_namespaces(), (HOSTILE, '/')]\n"
    "    def get_topic_names_and_types(self, *rest):\n"
    "        return [*super().get_topic_names_and_types(*rest), (HOSTILE, [HOSTILE])]\n"
    "    def get_publishers_info_by_topic(self, topic, *rest):\n"
    "        return [end] if topic == HOSTILE else super().get_publishers_info_by_topic(topic, *rest)\n"
    "    def get_subscriptions_info_by_topic(self, topic, *rest):\n"
    "        return [] if topic == HOSTILE else super().get_subscriptions_info_by_topic(topic, *rest)\n"
    "session = LabSession()\nsession.node.__class__ = Known",
    "kept = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n"
    "class Talker(Node):\n"
    "    def __init__(self):\n"
    "        super().__init__('talker')\n"
    "        self.said = [(self.create_publisher(String, topic, 10), String(data=HOSTILE))\n"
    "                     for topic in ('/robot/state', '/robot/status')]\n"
    "        log = Log(level=20, name=HOSTILE, msg=HOSTILE, file=HOSTILE, function=HOSTILE)\n"
    "        self.said.append((self.create_publisher(Log, '/rosout', kept), log))\n"
    "        self.create_timer(0.1, self.talk)\n"
    "    def talk(self):\n"
    "        for publisher, message in self.said:\n"
    "            publisher.publish(message)\n"
    "talker = session.run(Talker)\nheard = TopicLog(session.node, '/robot/status', String)\nheard.wait_for(1)",
    "Dashboard(session, views=[GraphView(session), NodeLog(session), CommandPanel(session)])",
    "TopicMonitor(session, '/robot/status')",
    "display(heard, session.node)",
]


@pytest.mark.thorough
def test_no_name_and_no_text_of_a_stranger_runs(lab: Lab, open_tab: Callable[[str], Tab]) -> None:
    lab.write("hostile.ipynb", CELLS)
    tab = open_tab("hostile.ipynb")
    tab.run_all(len(CELLS))
    page = tab.page
    for place in (
        ".ros2lab-graph",
        ".ros2lab-node-log",
        ".ros2lab-panel",
        ".ros2lab-dashboard",
        ".ros2lab-monitor",
    ):
        tab.scroll_to(place)
        expect(page.locator(place).first).to_contain_text(MARK, timeout=TIMEOUT_MS)
    tab.scroll_to(".ros2lab-graph")
    page.locator(".ros2lab-part", has_text=MARK).first.focus()
    expect(page.locator(".ros2lab-details")).to_contain_text(MARK)
    page.wait_for_load_state("networkidle")
    assert page.evaluate("window.ran || []") == []
    assert (
        page.locator(
            "[onerror], [onload], .jp-Notebook img[src='x'], .jp-Notebook a[href^='javascript']"
        ).count()
        == 0
    )
    assert tab.complaints == []
