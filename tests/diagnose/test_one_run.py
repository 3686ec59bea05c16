"""What a program does in one run: branches, loops with an end, and which node a line is about."""

from __future__ import annotations

import ast
import textwrap
from pathlib import Path

import pytest
from one_file import sources_of
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.code.flow_faults import flow_faults
from ros2lab.diagnose.sources.one_run import calls_in_one_run

NODES = """\
import sys
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Left(Node):
    def __init__(self):
        super().__init__('left')
        self.pose = None
        self.timer = self.create_timer(1.0, self.tick)

    def tick(self):
        self.pose = self.get_clock().now()


class Right(Left):
    pass


def begin():
    rclpy.init()
    rclpy.spin(Right())


def main():
"""
SPUN = "\nrclpy.spin(node)"


def driver(body: str, root: Path) -> dict[str, str]:
    """Return the fixes, by code, for a program that a launch file starts under a name."""
    files = Files.right(NAMES[1])
    files.texts[files.path("driver")] = NODES + textwrap.indent(body, "    ")
    files.change("launch/robot.launch.py", "executable='DRIVER'", "executable='DRIVER', name='pair'")
    return {finding.code: finding.fix for finding in of_workspace(files.write(root))}


@pytest.mark.parametrize(
    ("body", "most"),
    [
        ("made()\nmade()", 2),
        ("if x:\n    made()\nelse:\n    made()", 1),
        ("if x:\n    made()\n    return\nmade()", 1),
        ("if x:\n    made()\nmade()", 2),
        ("if x:\n    made()\n    sys.exit()\nelif y:\n    made()\nmade()", 2),
        ("node = made() if x else made()", 1),
        ("match x:\n    case 1:\n        made()\n    case _:\n        made()", 1),
        ("try:\n    made()\nexcept OSError:\n    made()", 1),
        ("try:\n    made()\nfinally:\n    made()", 2),
        ("with made() as a, made() as b:\n    pass", 2),
        ("for a in b:\n    made()\nelse:\n    pass", 1),
        ("def inner():\n    made()\nlambda: made()", 0),
        ("given(made(), other=made())", 2),
        ("raise made()\nmade()", 1),
    ],
)
def test_how_often_a_run_makes_a_call(body: str, most: int) -> None:
    (function,) = ast.parse(f"def run():\n{textwrap.indent(body, '    ')}").body
    assert isinstance(function, ast.FunctionDef)
    calls = calls_in_one_run(function, lambda call: ast.unparse(call.func) == "made")
    assert len(calls) == most


RIGHT = [
    f"rclpy.init()\nif '--l' in sys.argv:\n    node = Left()\nelse:\n    node = Right(){SPUN}",
    f"if '--r' in sys.argv:\n    begin()\n    return\nrclpy.init()\nnode = Left(){SPUN}",
    f"rclpy.init()\nnode = rclpy.create_node('probe')\nnode.destroy_node()\nnode = Left(){SPUN}",
    f"rclpy.init()\nnode, probe = Left(), Right()\nprobe.destroy_node(){SPUN}",
    f"rclpy.init()\nnode = Left()\nwhile node.pose is None:\n    rclpy.spin_once(node)\n    time.sleep(1){SPUN}",
    f"rclpy.init()\nnode = Left()\nwhile True:\n    rclpy.spin_once(node)\n    if node.pose:\n        time.sleep(1)\n        break{SPUN}",
]


@pytest.mark.parametrize("body", RIGHT)
def test_what_only_looks_like_two_is_no_alarm(tmp_path: Path, body: str) -> None:
    of_names = set() if "probe" in body else {"name-twice"}  # name= does rename both
    quiet = {"life-order", "callback-waits", "rclpy-init-twice", "spin-missing"} | of_names
    assert not driver(body, tmp_path).keys() & quiet


WRONG = {
    "name-twice": "rclpy.init()\nif len(sys.argv) > 9:\n    print('many')\nleft, right = Left(), Right()\nexecutor = SingleThreadedExecutor()\nexecutor.add_node(left)\nexecutor.add_node(right)\nexecutor.spin()",
    "rclpy-init-twice": "rclpy.init()\nbegin()",
    "life-order": "rclpy.init()\nnode = Left()\nexecutor = SingleThreadedExecutor()\nexecutor.add_node(node)\nnode.destroy_node()\nexecutor.spin()",
    "callback-waits": "rclpy.init()\nnode = Left()\ntry:\n    while rclpy.ok():\n        rclpy.spin_once(node)\n        time.sleep(1.0)\nexcept KeyboardInterrupt:\n    pass",
}


@pytest.mark.parametrize("code", WRONG)
def test_what_one_run_does_is_told(tmp_path: Path, code: str) -> None:
    assert code in driver(WRONG[code], tmp_path)


TIMER = """\
from rclpy.node import Node


class Once(Node):
    def __init__(self):
        super().__init__('once')
        self.timer = self.create_timer(0.0, CALLBACK)

    def tick(self):
        BODY

    def stop(self):
        END
"""


@pytest.mark.parametrize(
    ("callback", "body", "end", "is_told"),
    [
        ("self.tick", "self.timer.cancel()", "pass", False),
        ("self.tick", "self.stop()", "self.destroy_timer(self.timer)", False),
        ("self.tick", "raise SystemExit", "pass", False),
        ("lambda: self.stop()", "pass", "self.timer.cancel()", False),
        ("self.tick", "self.get_logger().info('tick')", "pass", True),
    ],
)
def test_a_timer_without_a_period_may_run_once(
    tmp_path: Path, callback: str, body: str, end: str, is_told: bool
) -> None:
    text = TIMER.replace("CALLBACK", callback).replace("BODY", body).replace("END", end)
    codes = [finding.code for finding in flow_faults(sources_of(text, tmp_path))]
    assert ("period" in codes) == is_told
