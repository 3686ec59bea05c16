"""A wrong field of a message: of those that it has, only what fits its use is offered."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_workspace

SUBSCRIBER = """\
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Follower(Node):
    def __init__(self):
        super().__init__('follower')
        self.limit = 0.0
        self.create_subscription(Twist, '/max_vel', self.on_limit, 10)

    def on_limit(self, msg):
        self.limit = FIELD


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Follower())
"""
FLOAT = (
    "write Float32 instead of Twist in the subscription on line 10, with `from std_msgs.msg import Float32`"
)


@pytest.mark.parametrize(
    ("field", "sent", "topic", "fix"),
    [
        ("msg.data", "std_msgs.msg.Float32", "/max_vel", FLOAT),
        ("msg.data", "std_msgs.msg.Float32", "max_vel", FLOAT),
        ("msg.x", "geometry_msgs.msg.Point", "/max_vel", "write Point instead of Twist in the subscription on line 10, with `from geometry_msgs.msg import Point`"),
        ("msg.data", "std_msgs.msg.Float32", "/min_vel", "write one of: linear, angular"),
        ("msg.data", "geometry_msgs.msg.Twist", "/max_vel", "write one of: linear, angular"),
        ("msg.liner.x", "std_msgs.msg.Float32", "/max_vel", "write one of: linear, angular"),
    ],
)  # fmt: skip
def test_what_is_published_tells_whether_the_field_or_the_type_is_wrong(
    tmp_path: Path, field: str, sent: str, topic: str, fix: str
) -> None:
    home, _, kind = sent.rpartition(".")
    code = SUBSCRIBER.replace("geometry_msgs.msg", home).replace("Twist", kind).replace("follower", "sender")
    made = f"self.pub = self.create_publisher({kind}, {topic!r}, 10)"
    lines = [made if "create_sub" in line else line for line in code.split("\n")]
    files = right_workspace().put("node", SUBSCRIBER.replace("FIELD", field))
    files.put(
        "my_bot/sender.py",
        "\n".join("        " * (line == made) + line for line in lines).replace("FIELD", "0.0"),
    )
    found = of_workspace(files.write(tmp_path))
    assert [finding.fix for finding in found if finding.code == "message-field"] == [fix]


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
