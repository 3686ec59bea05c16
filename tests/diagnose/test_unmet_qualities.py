"""Subscriptions that require what no publisher offers: by any policy, with what to write where."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of
from right_workspace import right_workspace

from ros2lab.diagnose import of_text, of_workspace
from ros2lab.diagnose.nodes.qos_written import misplaced_policies

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


POLICIES = """\
from enum import IntEnum
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSPresetProfiles, QoSProfile, ReliabilityPolicy
from rclpy.qos import QoSReliabilityPolicy
from std_msgs.msg import Bool

BEST = ReliabilityPolicy.BEST_EFFORT


class Depth(IntEnum):
    SMALL = 2


class Lamp(Node):
    def __init__(self):
        super().__init__('lamp')
        self.pub = self.create_publisher(Bool, 'lamp', GIVEN)
"""


@pytest.mark.parametrize(
    ("given", "fix"),
    [
        ("ReliabilityPolicy.BEST_EFFORT", "QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)"),
        ("BEST", "QoSProfile(depth=10, reliability=BEST)"),
        ("DurabilityPolicy.TRANSIENT_LOCAL", "durability=DurabilityPolicy.TRANSIENT_LOCAL"),
        ("HistoryPolicy.KEEP_LAST", "history=HistoryPolicy.KEEP_LAST"),
        ("QoSProfile(depth=ReliabilityPolicy.RELIABLE)", "depth=10, reliability=ReliabilityPolicy.RELIABLE"),
        ("QoSProfile(depth=1, reliability=DurabilityPolicy.VOLATILE)", "write durability=DurabilityPolicy.V"),
        (
            "QoSProfile(depth=1, durability=BEST, reliability=BEST)",
            "give durability a value of DurabilityPolicy",
        ),
        ("Depth.SMALL", ""),
        ("QoSProfile(depth=Depth.SMALL, reliability=BEST)", ""),
        ("QoSProfile(depth=1, reliability=QoSReliabilityPolicy.BEST_EFFORT)", ""),
        ("QoSPresetProfiles.SENSOR_DATA.value", ""),
    ],
)
def test_a_policy_is_no_depth_and_no_other_policy(tmp_path: Path, given: str, fix: str) -> None:
    found = [*misplaced_policies(sources_of(POLICIES.replace("GIVEN", given), tmp_path))]
    assert len(found) == bool(fix)
    assert all(fix in finding.fix for finding in found)
