"""A method that is asked of nobody, or of a module or a class without it: the object at hand that has it is meant."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

NODE = """\
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.pub = self.create_publisher(String, 'topic', 10)
        self.timer = self.create_timer(1.0, self.tick)
        self.count = 0
        {first}

    def tick(self):
        self.pub.publish(String(data='a'))
        {inside}


def main():
    rclpy.init()
    node = Talker()
    executor = SingleThreadedExecutor()
    {added}
    executor.spin()
    {below}
    rclpy.shutdown()
"""


def of(**lines: str) -> str:
    usual = {
        "first": "self.name = 'a'",
        "inside": "self.count += 1",
        "added": "executor.add_node(node)",
        "below": "node.destroy_node()",
    }
    return NODE.format(**{**usual, **lines})


def fixed(text: str, fix: str) -> str:
    match = re.search(r"write `?(?P<new>.+?)`? instead of `?(?P<old>[^`]+)`?$", fix)
    if match:
        return text.replace(match["old"], match["new"], 1)
    written = re.search(r"write `(?P<new>.+)`$", fix)
    assert written, fix
    return written["new"]


@pytest.mark.parametrize(
    ("where", "wrong", "right"),
    [
        ("first", "rclpy.create_timer(1.0, self.tick)", "self.create_timer(1.0, self.tick)"),
        ("first", "rclpy.create_publisher(String, 'b', 10)", "self.create_publisher(String, 'b', 10)"),
        ("inside", "self.count = rclpy.get_clock().now()", "self.count = self.get_clock().now()"),
        ("first", "rclpy.declare_parameter('speed', 1.0)", "self.declare_parameter('speed', 1.0)"),
        (
            "inside",
            "self.count = rclpy.get_parameter('a').value",
            "self.count = self.get_parameter('a').value",
        ),
        ("inside", "rclpy.publish(String())", "self.pub.publish(String())"),
        ("inside", "self.publish(String())", "self.pub.publish(String())"),
        ("inside", "publish(String())", "self.pub.publish(String())"),
        ("inside", "rclpy.cancel()", "self.timer.cancel()"),
        ("inside", "rclpy.info('x')", "self.get_logger().info('x')"),
        ("inside", "rclpy.get_logger().info('x')", "self.get_logger().info('x')"),
        ("below", "rclpy.get_logger().info('x')", "node.get_logger().info('x')"),
        ("below", "get_logger().info('x')", "node.get_logger().info('x')"),
        ("below", "rclpy.destroy_node()", "node.destroy_node()"),
        ("below", "destroy_node()", "node.destroy_node()"),
        ("added", "rclpy.add_node(node)", "executor.add_node(node)"),
        ("below", "print(get_clock().now())", "print(node.get_clock().now())"),
    ],
)
def test_the_object_that_has_the_method(tmp_path: Path, where: str, wrong: str, right: str) -> None:
    files = Files.right(NAMES[1]).put("node", of(**{where: wrong}))
    codes = ("attribute-missing", "name-undefined")
    (found,) = (f for f in of_workspace(files.write(tmp_path)) if f.code in codes)
    assert fixed(wrong, found.fix) == right
    ast.parse(of(**{where: right}))


def test_a_logger_with_a_name_is_a_function_of_its_module(tmp_path: Path) -> None:
    """The method takes no name, so the node's is not meant."""
    for number, (wrong, fix) in enumerate(
        (
            ("rclpy.get_logger('a').info('x')", "write `get_logger('a')`, with `from rclpy.logging import get_logger` at the top"),
            ("get_logger('a').info('x')", "write `from rclpy.logging import get_logger` at the top"),
        )
    ):  # fmt: skip
        files = Files.right(NAMES[1]).put("node", of(below=wrong))
        found = of_workspace(files.write(tmp_path / str(number)))
        assert fix in [finding.fix for finding in found]


def test_of_two_publishers_none_is_chosen(tmp_path: Path) -> None:
    text = of(inside="publish(String())").replace(
        "        self.timer",
        "        self.other = self.create_publisher(String, 'b', 10)\n        self.timer",
    )
    files = Files.right(NAMES[1]).put("node", text)
    (found,) = (f for f in of_workspace(files.write(tmp_path)) if f.code == "name-undefined")
    assert "self." not in found.fix
