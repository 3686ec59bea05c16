"""What is published once and kept, and subscriptions that ask only for what is new."""

from __future__ import annotations

import pytest

from ros2lab.diagnose.nodes.topic_faults import ends_of, topic_faults
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource

NODES = """\
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from std_msgs.msg import String

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Office(Node):
    def __init__(self):
        super().__init__('office')
        self.pub = self.create_publisher(String, 'trail', OFFER)
        SEND

    def send(self):
        self.pub.publish(String(data='x'))


class Walker(Node):
    def __init__(self):
        super().__init__('walker')
        self.create_subscription(String, 'trail', self.got, QOS)
        self.pub = self.create_publisher(String, 'steps', 10)
        self.create_timer(0.1, self.send)

    def got(self, msg):
        print(msg)

    def send(self):
        self.pub.publish(String())
"""
SENT = "self.pub.publish(String(data='x'))"
ONCE = "self.timer = self.create_timer(1.0, self.send)"
ENDED = "self.timer.cancel()"
KEEPS = "durability=DurabilityPolicy.TRANSIENT_LOCAL"


def fixes(qos: str, send: str = SENT, offer: str = "LATCHED") -> list[str]:
    text = NODES.replace("QOS", qos).replace("SEND", send).replace("OFFER", offer)
    text = (
        text
        if send != SENT
        else text.replace("    def send(self):\n        self.pub.publish(String(data='x'))\n", "")
    )
    text = (
        text.replace("def send(self):", f"def send(self):\n        {ENDED}")
        if send.startswith(ONCE)
        else text
    )
    sources = NodeSources({"pk.map": PythonSource("pk.map", "map.py", text)})
    found = topic_faults(ends_of(sources))
    return [finding.fix for finding in found if finding.code == "qos-mismatch"]


@pytest.mark.parametrize("send", [SENT, "self.send()", ONCE])
@pytest.mark.parametrize(
    ("qos", "written"),
    [
        ("1", f"QoSProfile(depth=1, {KEEPS})"),
        ("QoSProfile(depth=5)", f"QoSProfile(depth=5, {KEEPS})"),
        ("qos_profile_sensor_data", f"QoSProfile(depth=1, {KEEPS})"),
    ],
)
def test_the_subscription_is_written_so_that_it_receives_what_is_kept(
    qos: str, written: str, send: str
) -> None:
    assert fixes(qos, send) == [f"write `self.create_subscription(String, 'trail', self.got, {written})`"]


@pytest.mark.parametrize(
    ("qos", "send", "offer"),
    [
        ("LATCHED", SENT, "LATCHED"),
        ("10", "self.create_timer(1.0, self.send)", "LATCHED"),
        ("10", "while True:\n            self.send()", "LATCHED"),
        ("10", SENT, "10"),
        ("10", f"self.create_timer(1.0, lambda: {SENT})", "LATCHED"),
        ("10", f"{SENT}; self.again(self.pub)", "LATCHED"),
        ("10", ONCE.replace("self.timer = ", ""), "LATCHED"),
        ("10", f"{ONCE}; self.create_service(Trigger, 'a', self.send)", "LATCHED"),
        ("10", f"if self.pub.get_subscription_count(): {SENT}", "LATCHED"),
    ],
)
def test_what_is_kept_on_both_sides_or_published_again_is_right(qos: str, send: str, offer: str) -> None:
    assert not fixes(qos, send, offer)
