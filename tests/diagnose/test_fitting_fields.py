"""A wrong field of a message: of those that it has, only what fits its use is offered."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_workspace


@pytest.mark.parametrize(
    ("kind", "line", "fix"),
    [
        ("PointStamped", "msg.position.x = 1.0", "write msg.point instead of msg.position"),
        ("TwistStamped", "msg.vel.linear.x = 1.0", "write msg.twist instead of msg.vel"),
        ("PointStamped", "msg.head.frame_id = 'map'", "write msg.header instead of msg.head"),
        ("Twist", "msg.speed.x = 1.0", "write one of: linear, angular"),
        ("PoseStamped", "msg.position.x = 1.0", "write pose.position instead of position"),
        ("PointStamped", "msg.place = 3.0", "write one of: header, point"),
        ("Inertia", "msg.weight = 3.0", "write one of: m, ixx, ixy, ixz, iyy, iyz, izz"),
    ],
)
def test_what_fits_the_use_is_offered(tmp_path: Path, kind: str, line: str, fix: str) -> None:
    code = f"""\
import rclpy
from geometry_msgs.msg import {kind}
from rclpy.node import Node


class Star(Node):
    def __init__(self):
        super().__init__('star')
        self.pub = self.create_publisher({kind}, 'star', 10)
        self.create_timer(0.5, self.tick)

    def tick(self):
        msg = {kind}()
        {line}
        self.pub.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Star())
"""
    found = of_workspace(right_workspace().put("node", code).write(tmp_path))
    assert [finding.fix for finding in found if finding.code == "message-field"] == [fix]
