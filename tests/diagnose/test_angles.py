"""Angles that are taken for components of a quaternion, and quaternions that are right."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.units import unit_faults
from ros2lab.diagnose.finding import Finding

NODE = """\
import math
from geometry_msgs.msg import PoseStamped, Quaternion, TransformStamped, Twist, Vector3
from rclpy.node import Node


class Snail(Node):
    def __init__(self):
        super().__init__('snail')
        self.heading = 0.0
        self.degrees = 90.0
        self.speed = 1.0
        self.pose = PoseStamped()
        self.create_subscription(PoseStamped, 'pose', self.step, 10)

    def step(self, msg: PoseStamped):
        transform, twist, angles = TransformStamped(), Twist(), Vector3()
        self.x = self.speed * math.cos(self.heading)
        self.y = math.sin(math.radians(self.degrees))
        LINE
"""


def told(line: str, folder: Path) -> list[Finding]:
    return [*unit_faults(sources_of(NODE.replace("LINE", line), folder, "snail"))]


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("self.pose.pose.orientation.z = self.heading", "z = math.sin(self.heading / 2) and w = math.cos("),
        ("self.pose.pose.orientation.z = self.degrees", "math.sin(math.radians(self.degrees) / 2)"),
        ("t = TransformStamped(); t.transform.rotation.z = math.atan2(1.0, 2.0)", "math.sin(math.atan2(1.0, 2.0) / 2)"),
        ("q = Quaternion(x=0.0, y=0.0, z=self.heading, w=1.0)", "math.sin(self.heading / 2)"),
        ("self.turned = math.pi / 2; self.turned += twist.angular.z * 0.1; self.pose.pose.orientation.z = self.turned", "math.sin(self.turned / 2)"),
        ("yaw = math.radians(30); q = Quaternion(); q.w = yaw", "math.sin(yaw / 2)"),
        ("yaw = msg.pose.orientation.z; self.x = math.cos(yaw)", "write yaw = math.atan2("),
    ],
)  # fmt: skip
def test_an_angle_is_no_component(tmp_path: Path, line: str, fix: str) -> None:
    (found,) = told(line, tmp_path)
    assert fix in found.fix


@pytest.mark.parametrize(
    "line",
    [
        "self.pose.pose.orientation.z = math.sin(self.heading / 2)",
        "self.pose.pose.orientation.z = self.speed",
        "self.pose.pose.position.z = self.heading",
        "t = Twist(); t.angular.z = self.heading",
        "v = Vector3(); v.z = self.heading",
        "z = math.radians(30); z = math.sin(z / 2); self.pose.pose.orientation.z = z",
        "z = msg.pose.orientation.z; w = msg.pose.orientation.w; yaw = 2 * math.atan2(z, w); self.x = math.cos(yaw)",
        "self.pose.pose.orientation.z = msg.pose.orientation.z",
    ],
)
def test_a_component_is_no_angle(tmp_path: Path, line: str) -> None:
    assert told(line, tmp_path) == []
