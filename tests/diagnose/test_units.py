"""Times in another unit than is meant, and sums and comparisons in which all is of one unit."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.units import unit_faults
from ros2lab.diagnose.finding import Finding

NODE = """\
import time
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSProfile

LIMIT = 2.5
TIMEOUT_NS = 500_000_000


class Runner(Node):
    def __init__(self):
        super().__init__('runner')
        self.drive_time = self.declare_parameter('drive_time', 5.0).value
        self.declare_parameter('limit', LIMIT)
        self.declare_parameter('wait_ns', 2_000_000_000)
        self.limit = self.get_parameter('limit').get_parameter_value().double_value
        self.start = self.get_clock().now()
        self.begin = time.time()
        self.first = time.monotonic_ns()

    def step(self, msg):
        now = self.get_clock().now()
        LINE
"""


def told(line: str, folder: Path) -> list[Finding]:
    return [*unit_faults(sources_of(NODE.replace("LINE", line), folder, "runner"))]


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("if (now - self.start).nanoseconds < self.drive_time: return", "/ 1e9 instead of"),
        ("late = (now - self.start).nanoseconds; print(late > LIMIT)", "write late / 1e9 instead of late"),
        ("if time.monotonic_ns() - self.first >= 3: return", "write (time.monotonic_ns() - self.first) / 1e9"),
        ("if now.nanoseconds - self.begin > 1: return", "write now.nanoseconds / 1e9"),
        ("age = time.time() - now.nanoseconds", "write now.nanoseconds / 1e9"),
        ("if 5 < time.time_ns() - self.first: return", "/ 1e9"),
        ("if (now - self.start).nanoseconds // 1000 > 2: return", "/ 1e6"),
        ("age = now.nanoseconds / 1e9 - msg.header.stamp.nanosec", "write msg.header.stamp.nanosec / 1e9"),
        ("if (now - self.start).nanoseconds > self.get_parameter('drive_time').value: return", "/ 1e9 instead of"),
        ("wait = self.get_parameter('drive_time').get_parameter_value().double_value; print((now - self.start).nanoseconds > wait)", "/ 1e9 instead of"),
        ("if (now - self.start).nanoseconds > self.limit: return", "/ 1e9 instead of"),
        ("qos = QoSProfile(depth=5, lifespan=Duration(nanoseconds=200))", "write Duration(seconds=200)"),
        ("self.get_clock().sleep_for(Duration(nanoseconds=5))", "write Duration(seconds=5)"),
    ],
)  # fmt: skip
def test_a_mixture_is_told_with_the_factor(tmp_path: Path, line: str, fix: str) -> None:
    (found,) = told(line, tmp_path)
    assert fix in found.fix


@pytest.mark.parametrize(
    "line",
    [
        "if (now - self.start).nanoseconds / 1e9 < self.drive_time: return",
        "if (now - self.start).nanoseconds * 1e-9 < LIMIT: return",
        "if (now - self.start).nanoseconds < self.drive_time * 1e9: return",
        "if (now - self.start).nanoseconds > TIMEOUT_NS: return",
        "if (now - self.start).nanoseconds / 1e9 > self.get_parameter('drive_time').value: return",
        "if (now - self.start).nanoseconds > self.get_parameter('wait_ns').value: return",
        "if (now - self.start).nanoseconds > self.get_parameter('declared elsewhere').value: return",
        "if (now - self.start).nanoseconds > self.get_parameter('drive_time').value * 1e9: return",
        "if (now - self.start).nanoseconds > 2_000_000_000: return",
        "if (now - self.start).nanoseconds <= 0: return",
        "if now.nanoseconds / 1e6 > 200: return",
        "age = now.nanoseconds / 1e9 - msg.header.stamp.sec - msg.header.stamp.nanosec / 1e9",
        "stamp = msg.header.stamp.sec + msg.header.stamp.nanosec * 1e-9",
        "if time.time() - self.begin > 0.2: return",
        "if now - self.start > Duration(seconds=2): return",
        "before = now - Duration(nanoseconds=1)",
        "Duration(seconds=1, nanoseconds=5)",
        "Duration(nanoseconds=200_000_000)",
        "if msg.nanoseconds == 0: return",
        "if now.nanoseconds % 2 == 1: return",
    ],
)
def test_what_is_of_one_unit_is_left_alone(tmp_path: Path, line: str) -> None:
    assert told(line, tmp_path) == []


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("self.get_logger().info('a', throttle_duration_sec=2000)", "write 2.0 instead of 2000 if"),
        ("self.get_logger().info('a', throttle_duration_sec=500)  # each 0.5 seconds", "write 0.5 instead of 500"),
        ("# not more than one line each two seconds\n        self.get_logger().info('a', throttle_duration_sec=2000)", "write 2.0 instead of 2000"),
        ("rclpy.spin_once(self, timeout_sec=100)  # 100 ms", "write 0.1 instead of 100"),
        ("wait_ms = 500; self.client.wait_for_service(timeout_sec=wait_ms)", "write wait_ms / 1000 instead of wait_ms"),
        ("self.create_timer(1000, self.step)", "write 1.0 instead of 1000 if"),
        ("self.create_timer(500, self.step)  # 0.5 s", "write 0.5 instead of 500"),
    ],
)  # fmt: skip
def test_milliseconds_for_a_parameter_that_counts_seconds(tmp_path: Path, line: str, fix: str) -> None:
    (found,) = told(line, tmp_path)
    assert fix in found.fix


@pytest.mark.parametrize(
    "line",
    [
        "self.get_logger().info('a', throttle_duration_sec=2.0)  # two seconds",
        "self.get_logger().info('a', throttle_duration_sec=3600)",
        "self.client.wait_for_service(timeout_sec=1000)",
        "self.client.wait_for_service(timeout_sec=5)  # 5 s",
        "wait_ms = 500; self.client.wait_for_service(timeout_sec=wait_ms / 1000)",
        "self.create_timer(60, self.step)  # once a minute",
        "self.create_timer(LIMIT, self.step)",
    ],
)
def test_seconds_for_a_parameter_that_counts_seconds(tmp_path: Path, line: str) -> None:
    assert told(line, tmp_path) == []
