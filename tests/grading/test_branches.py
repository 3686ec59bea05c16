"""What a branch plainly does with a command that nobody could send."""

from __future__ import annotations

import textwrap

import pytest

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.grading.code.branches import branches
from ros2lab.grading.code.running import running

NODE = """
import os
import sys
import time
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Taker(Node):
    def __init__(self):
        super().__init__("taker")
        self.get_logger().info("Here I am")
        self.state = "idle"
        self.create_timer(1.0, self.halt)
        self.create_subscription(String, "/robot/command", self.take, 10)

{}

def main():
    rclpy.init()
    rclpy.spin(Taker())
"""
BRANCHED = """
    def take(self, msg):
        {}
        if msg.data == "start":
            time.sleep(40.0)
            self.get_logger().info("Go")
        elif msg.data == "stop":
            {}
        else:
            self.get_logger().warning("What?")

    def halt(self):
        {}
"""


def told(methods: str, *findings: Finding) -> list[str]:
    source = PythonSource("p.taker", "taker.py", NODE.format(methods))
    return branches([source], [*running([source], {"main"})], ["start", "stop"], findings).get("stop", [])


@pytest.mark.parametrize(
    ("before", "branch", "helper", "is_told"),
    [
        ("pass", "self.gone = True", "pass", ["mute"]),
        ("pass", "self.get_logger().info('Halt')", "pass", []),
        ("pass", "self.get_logger().debug('Halt')", "pass", ["mute"]),
        ("self.get_logger().set_level(10)", "self.get_logger().debug('Halt')", "pass", []),
        ("pass", "print('halt')", "pass", []),
        ("self.get_logger().info(msg.data)", "self.gone = True", "pass", []),
        ("pass", "self.halt()", "self.get_logger().info('Halt')", []),
        ("pass", "self.halt()", "self.gone = True", ["mute"]),
        ("pass", "raise SystemExit", "pass", ["mute", "last"]),
        ("pass", "raise NotImplementedError('stop')", "pass", ["mute", "last"]),
        ("pass", "os._exit(0)", "pass", ["mute", "last"]),
        ("pass", "sys.exit()", "pass", ["mute", "last"]),
        ("pass", "rclpy.shutdown()", "pass", ["mute", "last"]),
        ("pass", "self.state = msg.data", "print(self.state)", []),
        ("pass", "if self.state:\n                raise SystemExit", "pass", ["mute"]),
        ("say = self.get_logger().info", "say('Halt')", "pass", []),
    ],
)
def test_what_a_branch_plainly_is(before: str, branch: str, helper: str, is_told: list[str]) -> None:
    assert told(BRANCHED.format(before, branch, helper)) == is_told


@pytest.mark.parametrize(
    ("code", "is_told"),
    [
        ("if msg.data in ('stop', 'start'):\n    raise SystemExit", []),
        ("if msg.data != 'stop':\n    raise SystemExit", []),
        ("if msg.data == 'stop' and self.state:\n    raise SystemExit", []),
        (
            "try:\n    if msg.data == 'stop':\n        raise ValueError\nexcept ValueError:\n    pass",
            ["mute"],
        ),
        (
            "match msg.data:\n    case 'stop':\n        raise SystemExit\n    case _:\n        print('?')",
            ["last"],
        ),
        ("if msg.data == 'start':\n    print('go')\nif msg.data == 'stop':\n    self.x = 1", ["mute"]),
    ],
)
def test_of_no_branch_that_is_not_known_anything_is_said(code: str, is_told: list[str]) -> None:
    assert told("    def take(self, msg):\n" + textwrap.indent(code, " " * 8)) == is_told


def test_a_line_that_fails_ends_the_program() -> None:
    methods = BRANCHED.format("pass", "del self.gone", "pass")
    line = 1 + [*NODE.format(methods).splitlines()].index("            del self.gone")
    assert told(methods, Finding("attribute-missing", "Taker has no attribute gone.", f"taker.py:{line}"))[1:]
