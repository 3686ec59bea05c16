"""Queues that are too short for what is published at once, and queues that are long enough."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.bursts import burst_faults

NODES = """
    import time
    from rclpy.node import Node
    from rclpy.qos import HistoryPolicy, QoSProfile
    from std_msgs.msg import Int32

    COUNT = 5
    NAMES = ['a', 'b', 'c']

    class Setter(Node):
        def __init__(self):
            super().__init__('setter')
            self.pub = self.create_publisher(Int32, 'pages', 10)
            self.create_timer(1.0, self.batch)

        def batch(self):
            LINES

    class Press(Node):
        def __init__(self):
            super().__init__('press')
            self.printed = 0
            self.create_subscription(Int32, 'pages', self.print_page, DEPTH)

        def print_page(self, msg):
            READ
"""
LOOP = "for page in range(COUNT):\n  self.pub.publish(Int32(data=page))"


def told(folder: Path, depth: str, lines: str = LOOP, read: str = "self.printed += 1") -> list[Finding]:
    indented = textwrap.indent(lines, " " * 12).strip()
    text = NODES.replace("LINES", indented).replace("DEPTH", depth).replace("READ", read)
    text = textwrap.dedent(text)
    return [*burst_faults(sources_of(text, folder, "press"))]


@pytest.mark.parametrize(
    ("depth", "lines", "count"),
    [
        ("1", LOOP, 5),
        ("QoSProfile(depth=2)", LOOP, 5),
        ("1", "for name in NAMES:\n  self.pub.publish(Int32(data=len(name)))", 3),
        ("3", "for a in (1, 2):\n  for b in range(10):\n    self.pub.publish(Int32(data=a * b))", 20),
        ("1", "self.pub.publish(Int32(data=1))\nself.pub.publish(Int32(data=2))", 2),
    ],
)
def test_a_queue_that_is_too_short_is_told(tmp_path: Path, depth: str, lines: str, count: int) -> None:
    (found,) = told(tmp_path, depth, lines)
    assert found.code == "queue-short"
    assert f"publishes {count} messages" in found.cause
    assert f"a depth of {max(10, count)}" in found.fix


@pytest.mark.parametrize(
    ("depth", "lines"),
    [
        ("10", LOOP),
        ("5", LOOP),
        ("QoSProfile(depth=1, history=HistoryPolicy.KEEP_ALL)", LOOP),
        ("1", "self.pub.publish(Int32(data=1))"),
        ("1", "if self.first:\n  self.pub.publish(Int32(data=1))\nelse:\n  self.pub.publish(Int32(data=2))"),
        ("1", "for page in range(COUNT):\n  self.pub.publish(Int32(data=page))\n  time.sleep(0.1)"),
        ("1", "for page in range(COUNT):\n  if page == 3:\n    self.pub.publish(Int32(data=page))"),
        ("1", "for page in range(COUNT):\n  self.pub.publish(Int32(data=page))\n  break"),
        ("1", "for page in self.pages:\n  self.pub.publish(Int32(data=page))"),
        ("self.depth", LOOP),
    ],
)
def test_a_queue_that_is_long_enough_is_left_alone(tmp_path: Path, depth: str, lines: str) -> None:
    assert told(tmp_path, depth, lines) == []


def test_who_wants_only_the_newest_is_left_alone(tmp_path: Path) -> None:
    assert told(tmp_path, "1", read="self.newest = msg.data") == []
