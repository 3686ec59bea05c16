"""What the code makes of publishers and subscriptions, as far as it tells without being run."""

from __future__ import annotations

import pytest

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
    assert _ends([source]) == [
        WrittenEnd("/cmd_vel", "geometry_msgs/msg/Twist", True, [], "status"),
        WrittenEnd("/robot/status", "std_msgs/msg/String", True, [2.0], "status"),
        WrittenEnd("/robot/command", "std_msgs/msg/String", False, [], "status"),
    ]


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("(PERIOD, self.tick)", "(PERIOD, self.tick"),
        ("def __init__(self):", "def __init__(self)"),
        ("(Node):", "(Node)"),
        ("message = String()", "message = String() // of the status"),
        ("message = String()", 'message = String("'),
        (
            "message = String()",
            "\n<<<<<<< HEAD\n        message = String()\n=======\n        message = String()\n>>>>>>> mine",
        ),
        ("import rclpy", "Here is the node:\n```python\nimport rclpy"),
        ("message = String()", "message = String()\n        if True\n            x = [1, 2"),
    ],
)
def test_what_a_file_makes_is_read_past_what_python_cannot_read(right: str, wrong: str) -> None:
    """It dies at once, and what its code plainly has is there all the same."""
    source = PythonSource("status", "status.py", SOURCE)
    spoilt = PythonSource("status", "status.py", SOURCE.replace(right, wrong, 1))
    assert right in SOURCE
    assert spoilt.readable_to < len(spoilt.text.split("\n"))
    assert _ends([spoilt]) == _ends([source])


def test_what_python_cannot_read_at_all_is_left_as_it_is() -> None:
    source = PythonSource("notes", "notes.py", "\n".join(["dear teacher ,"] * 20))
    assert source.as_meant() is source
