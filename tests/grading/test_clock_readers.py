"""Code that cannot tell a simulated clock from a real one is watched on one of them only."""

from __future__ import annotations

import pytest

from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.grading.code.clock_readers import clock_readers

BLIND = """
import math
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from my_robot.speeds import SPEED

class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        period = self.declare_parameter("timer_period", 0.2).value
        self.publisher = self.create_publisher(Twist, "/cmd_vel", 10)
        self.timer = self.create_timer(period, self.drive)
        self.count = 0

    def drive(self):
        HERE
        twist = Twist()
        twist.linear.x = SPEED * math.sin(self.count)
        self.publisher.publish(twist)

def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Driver())
"""


BLIND_LINES = (
    "self.count += 1",
    "self.get_logger().info(f'drive {self.count}')",
    "self.count = self.get_parameter('timer_period').value",
    "self.timer.cancel()",
    "assert rclpy.ok()",
)
TELLING_LINES = (
    "self.count = self.get_clock().now().nanoseconds",
    "self.count = self._clock.now()",
    "import time; self.count = time.monotonic()",
    "import sys; self.count = len(sys.argv)",
    "import os; self.count = 'x' in os.environ",
    "from rclpy.clock import Clock; self.count = Clock().now()",
    "from rosgraph_msgs.msg import Clock",
    "self.count = self.get_parameter('use_sim_time').value",
    "self.count = self.get_parameter('use_' + 'sim_' + 'time').value",
    "self.count = getattr(self, 'get_' + 'clo' + 'ck')()",
    "self.count = self.__dict__",
    "self.count = open('/proc/self/cmdline').read()",
    "self.count = self.timer.time_until_next_call()",
    "import threading",
    "import subprocess",
    "rclpy.spin_once(self, timeout_sec=0.1)",
    "self.count = eval('1')",
)


@pytest.mark.parametrize("line", [*BLIND_LINES, *TELLING_LINES])
def test_only_code_that_may_know_the_time_is_compared_on_both_clocks(line: str) -> None:
    source = PythonSource("my_robot.driver", "driver.py", BLIND.replace("HERE", line))
    assert source.tree.body
    assert clock_readers([source], {"my_robot"}) == ["my_robot.driver"] * (line in TELLING_LINES)
