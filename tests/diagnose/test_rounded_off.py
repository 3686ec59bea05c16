"""Received integers whose decimals are lost before they get into a field that holds a float."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.nodes.message_faults import message_faults

NODE = """\
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Float32, UInt8

MOST = 2.0
STEPS = 100


class Pedal(Node):
    def __init__(self):
        super().__init__('pedal')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(UInt8, 'pedal', self.pressed, 10)
        self.create_subscription(Float32, 'wheel', self.turned, 10)
        self.speed = 0.0

    def pressed(self, msg):
        out = Twist()
        LINE
        self.publisher.publish(out)

    def turned(self, msg):
        out = Twist()
        out.angular.z = msg.data // 10 * 1.0
        self.publisher.publish(out)
"""
LINES = {
    "out.linear.x = msg.data // 100 * MOST": "msg.data // 100",
    "out.linear.x = MOST * (msg.data // 255)": "msg.data // 255",
    "out.linear.x = int(msg.data / 100) * MOST": "int(msg.data / 100)",
    "out.linear.x = float(msg.data // 100)": "msg.data // 100",
    "out.linear.x = round(msg.data / 1000) * MOST": "round(msg.data / 1000)",
    "part = msg.data // 100\n        out.linear.x = part * MOST": "msg.data // 100",
    "self.speed = msg.data // 100 * MOST\n        out.linear.x = self.speed": "msg.data // 100",
    "out.linear.x = msg.data // 100": "msg.data // 100",
    "out.linear.x = msg.data / 100 * MOST": "",
    "out.linear.x = msg.data // 10 * 10 * 0.01": "",
    "out.linear.x, out.linear.y = float(msg.data // 60), float(msg.data % 60)": "",
    "out.linear.x = len(self.get_name()) // 2 * MOST": "",
    "out.linear.x = round(msg.data / 100, 2) * MOST": "",
    "out.linear.x = [0.0, 0.5, 1.0][msg.data // 100]": "",
}


@pytest.mark.parametrize(("line", "lost"), LINES.items(), ids=LINES)
def test_what_loses_its_decimals_is_told(tmp_path: Path, line: str, lost: str) -> None:
    sources = sources_of(NODE.replace("LINE", line), tmp_path)
    found = [one for one in message_faults(sources) if one.code == "rounded-off"]
    assert [one.cause.split("`")[1] for one in found] == [lost] * bool(lost)
    for one in found:
        assert one.fix.split("`")[1].startswith("msg.data / ")
