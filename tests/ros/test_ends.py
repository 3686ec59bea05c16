"""What the grader's observer is told of a topic's ends is what a node tells."""

from __future__ import annotations

import time

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from ros2lab.grading.watching import ends
from ros2lab.session import LabSession

TOPIC = "/room/word"
PATIENCE = 10.0  # s


def test_ends_are_told_as_a_node_tells_of_them(session: LabSession) -> None:
    node = session.node
    unreliable = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_publisher(String, TOPIC, latched)
    node.create_publisher(String, TOPIC, unreliable)
    node.create_subscription(String, TOPIC, lambda _message: None, unreliable)
    end = time.monotonic() + PATIENCE
    while len(ends.publishers(node, TOPIC)) < 2 and time.monotonic() < end:
        time.sleep(0.01)
    publishers, subscriptions = ends.publishers(node, TOPIC), ends.subscriptions(node, TOPIC)
    for told, known in (
        (publishers, node.get_publishers_info_by_topic(TOPIC)),
        (subscriptions, node.get_subscriptions_info_by_topic(TOPIC)),
    ):
        for name in ("node_name", "node_namespace", "topic_type", "endpoint_gid"):
            assert [getattr(one, name) for one in told] == [getattr(one, name) for one in known]
        assert [ends.quality("end", one) for one in told] == [
            f"end {one.qos_profile.reliability.name.lower()} {one.qos_profile.durability.name.lower()}"
            for one in known
        ]
    assert sorted(ends.quality("publisher", one) for one in publishers) == [
        "publisher best_effort volatile",
        "publisher reliable transient_local",
    ]
    assert [ends.node_name(one) for one in subscriptions] == [node.get_fully_qualified_name()]
    assert ends.publishers(node, "/nobody") == []
