"""Messages that a function sends as soon as it has made their publisher, when nobody can have met it."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.nodes.life_faults import life_faults

TEXT = """\
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


def main():
    rclpy.init()
    node = Node('bell')
    LINES
    rclpy.shutdown()
"""
MADE = "pub = node.create_publisher(String, 'bell', 10)"
SENT = "pub.publish(String(data='ding'))"


def codes(folder: Path, *lines: str) -> list[str]:
    text = TEXT.replace("LINES", "\n    ".join(lines))
    return [one.code for one in life_faults(sources_of(text, folder), ["pk.node.main"])]


@pytest.mark.parametrize(
    "lines",
    [
        (MADE, SENT),
        (MADE, "msg = String()", "msg.data = 'ding'", "pub.publish(msg)"),
        (MADE, "for _ in range(3):", "    print('ding')", SENT),
    ],
)
def test_a_message_that_nobody_can_receive_is_told(tmp_path: Path, lines: tuple[str, ...]) -> None:
    assert "sent-early" in codes(tmp_path, *lines)


@pytest.mark.parametrize(
    "lines",
    [
        (MADE, "while not pub.get_subscription_count():", "    rclpy.spin_once(node)", SENT),
        (MADE, "time.sleep(1.0)", SENT),
        (MADE, "rclpy.spin_once(node, timeout_sec=1.0)", SENT),
        (MADE, "while rclpy.ok():", f"    {SENT}", "    rclpy.spin_once(node, timeout_sec=1.0)"),
        (MADE, "for _ in range(5):", f"    {SENT}", "    rclpy.spin_once(node)"),
        (MADE, f"node.create_timer(1.0, lambda: {SENT})", "rclpy.spin(node)"),
        (MADE, "def tick():", f"    {SENT}", "", "node.create_timer(1.0, tick)", "rclpy.spin(node)"),
        (MADE, "start(pub)", "", "", "def start(pub):", f"    {SENT}"),
    ],
)
def test_one_that_is_waited_for_or_repeated_is_right(tmp_path: Path, lines: tuple[str, ...]) -> None:
    assert "sent-early" not in codes(tmp_path, *lines)
