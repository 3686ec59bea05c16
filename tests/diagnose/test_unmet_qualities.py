"""Subscriptions that require what no publisher offers: by any policy, with what to write where."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_text, of_workspace

IMPORTS = "from rclpy.duration import Duration\nfrom rclpy.qos import LivelinessPolicy, QoSProfile\n"
NODE = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool
IMPORTSLIMIT = 2


class Lamp(Node):
    def __init__(self):
        super().__init__('lamp')
        MADE

    def heard(self, msg):
        self.get_logger().info(str(msg.data))

    def blink(self):
        self.pub.publish(Bool(data=True))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Lamp())
"""
SAID = "[WARN] [guard]: New publisher discovered on topic 'lamp', offering incompatible QoS. No messages will be received from it. Last incompatible policy: "


def written(root: Path, asked: str, offered: str) -> Path:
    """Write a workspace in which one node asks for a quality and another one offers one."""
    listens = f"self.create_subscription(Bool, 'lamp', self.heard, {asked})"
    speaks = f"self.pub = self.create_publisher(Bool, 'lamp', {offered})\n        self.create_timer(0.3, self.blink)"
    files = right_workspace()
    for name, made, given in (("listener", listens, asked), ("node", speaks, offered)):
        imports = IMPORTS if "QoS" in given else ""
        files.texts[files.path(name)] = NODE.replace("MADE", made).replace("IMPORTS", imports)
    return files.write(root)


@pytest.mark.parametrize(
    ("asked", "offered", "policy", "profile"),
    [
        ("QoSProfile(depth=10, deadline=Duration(seconds=1))", "10", "DEADLINE", "QoSProfile(depth=10, deadline=Duration(seconds=1))"),
        ("QoSProfile(depth=10, deadline=Duration(nanoseconds=500000000))", "10", "DEADLINE", "QoSProfile(depth=10, deadline=Duration(seconds=0.5))"),
        ("QoSProfile(depth=5, deadline=Duration(seconds=LIMIT))", "QoSProfile(depth=5, deadline=Duration(seconds=3))", "DEADLINE", "QoSProfile(depth=5, deadline=Duration(seconds=2))"),
        ("QoSProfile(depth=1, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC)", "7", "LIVELINESS", "QoSProfile(depth=7, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC)"),
        ("QoSProfile(depth=1, liveliness_lease_duration=Duration(seconds=2))", "7", "LIVELINESS", "QoSProfile(depth=7, liveliness_lease_duration=Duration(seconds=2))"),
    ],
)  # fmt: skip
def test_the_profile_that_the_publisher_needs_is_written(
    tmp_path: Path, asked: str, offered: str, policy: str, profile: str
) -> None:
    first = of_text(f"{SAID}{policy}\n", written(tmp_path, asked, offered))[0]
    assert first.code == "qos-mismatch"
    assert f"self.create_publisher(Bool, 'lamp', {profile})" in first.fix


@pytest.mark.parametrize(
    ("asked", "offered"),
    [
        ("10", "QoSProfile(depth=10, deadline=Duration(seconds=1))"),
        (
            "QoSProfile(depth=10, deadline=Duration(seconds=3))",
            "QoSProfile(depth=10, deadline=Duration(seconds=1))",
        ),
        ("QoSProfile(depth=10, deadline=Duration(seconds=len(BY)))", "10"),
        ("10", "QoSProfile(depth=10, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC)"),
    ],
)
def test_who_offers_enough_is_not_blamed(tmp_path: Path, asked: str, offered: str) -> None:
    found = of_workspace(written(tmp_path, asked, offered))
    assert not [finding for finding in found if finding.code == "qos-mismatch"]
