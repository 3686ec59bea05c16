"""`ros2 doctor`: short, useful, and no traceback where things are broken."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture
def node(domain_id: int) -> Iterator[Node]:
    context = Context()
    rclpy.init(context=context, domain_id=domain_id)
    node = Node("talker", context=context)
    yield node
    node.destroy_node()
    context.shutdown()


def test_a_machine_that_works(ros2: Ros2) -> None:
    for command in ("doctor", "wtf"):
        said = ros2(command)
        assert (said.returncode, said.stderr) == (0, "")
        assert "All checks passed" in said.stdout


def test_the_report_says_what_this_is_and_who_is_there(ros2: Ros2, node: Node, domain_id: int) -> None:
    publisher = node.create_publisher(String, "chatter", 1)
    said = ros2("doctor", "--report")
    assert said.returncode == 0
    lines = {" ".join(line.split()) for line in said.stdout.splitlines()}
    assert {"node : /talker", "topic : /chatter", f"domain id : {domain_id}"} <= lines
    assert any("portable_ros2" in line for line in lines)
    assert "Publisher without subscriber detected on /chatter." in said.stderr
    node.destroy_publisher(publisher)


def test_two_that_do_not_understand_each_other_are_named(ros2: Ros2, node: Node) -> None:
    node.create_publisher(String, "chatter", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))
    node.create_subscription(String, "chatter", lambda _: None, 1)
    said = ros2("doctor")
    assert said.returncode == 0
    assert "talker -> talker on /chatter" in said.stderr
    strict = ros2("doctor", "--include-warnings")
    assert strict.returncode == 1
    assert "1 check(s) failed" in strict.stdout


@pytest.mark.parametrize(
    ("name", "value", "code", "words"),
    [
        ("ROS_DOMAIN_ID", "seven", 1, "no number from 0 to 232"),
        ("ROS_DOMAIN_ID", "233", 1, "no number from 0 to 232"),
        ("RMW_IMPLEMENTATION", "rmw_nowhere_cpp", 1, "is not installed"),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "NEARBY", 0, "none of SUBNET"),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF", 0, "no node finds another one"),
    ],
)
def test_settings_that_hurt_are_named(ros2: Ros2, name: str, value: str, code: int, words: str) -> None:
    said = ros2("doctor", **{name: value})
    assert said.returncode == code
    assert words in said.stderr
    assert "Traceback" not in said.stderr
