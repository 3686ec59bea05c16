"""What the code makes of publishers and subscriptions, as far as it tells without being run."""

from __future__ import annotations

from ros2lab.diagnose.node_source import NodeSources
from ros2lab.diagnose.python_source import PythonSource
from ros2lab.grading.evidence import WrittenEnd
from ros2lab.grading.files import _ends

SOURCE = """
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import String

PERIOD = 2.0


class Status(Node):
    def __init__(self):
        super().__init__("status")
        self.speed = self.create_publisher(Twist, "cmd_vel", 10)
        self.status = self.create_publisher(String, "/robot/status", 10)
        self.create_subscription(String, "/robot/command", self.on_command, 10)
        self.create_timer(PERIOD, self.tick)
        self.create_timer(0.1, self.on_condition)

    def tick(self):
        message = String()
        self.status.publish(message)

    def on_condition(self):
        if self.speed:
            self.speed.publish(Twist())

    def on_command(self, message):
        pass
"""


def test_topics_types_and_timers_are_read() -> None:
    source = PythonSource("status", "status.py", SOURCE)
    assert _ends(NodeSources({"status": source})) == [
        WrittenEnd("/cmd_vel", "geometry_msgs/msg/Twist", True, [], "status"),
        WrittenEnd("/robot/status", "std_msgs/msg/String", True, [2.0], "status"),
        WrittenEnd("/robot/command", "std_msgs/msg/String", False, [], "status"),
    ]
