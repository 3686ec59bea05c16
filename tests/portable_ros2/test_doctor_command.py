"""`ros2 doctor`: short, useful, and no traceback where things are broken."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable

import pytest
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from running import Running, until
from std_msgs.msg import String

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]


def test_a_machine_that_works(ros2: Ros2) -> None:
    for command in ("doctor", "wtf"):
        said = ros2(command)
        assert (said.returncode, said.stderr) == (0, "")
        assert "All checks passed" in said.stdout


def test_the_report_says_what_this_is_and_who_is_there(ros2: Ros2, node: Node, domain_id: int) -> None:
    publisher = node.create_publisher(String, "/chatter", 1)
    said = ros2("doctor", "--report")
    assert said.returncode == 0
    lines = {" ".join(line.split()) for line in said.stdout.splitlines()}
    assert {"node : /ns/talker", "topic : /chatter", f"domain id : {domain_id}"} <= lines
    assert any("portable_ros2" in line for line in lines)
    assert "Publisher without subscriber detected on /chatter." in said.stderr
    node.destroy_publisher(publisher)


def test_two_that_do_not_understand_each_other_are_named(ros2: Ros2, node: Node) -> None:
    node.create_publisher(String, "/chatter", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))
    node.create_subscription(String, "/chatter", lambda _: None, 1)
    said = ros2("doctor", "--report")
    expected = (
        "Error: QoS compatibility error found on topic '/chatter' (talker -> talker): Best effort publisher"
    )
    assert expected in said.stderr
    lines = {" ".join(line.split()) for line in said.stdout.splitlines()}
    assert {"topic [type] : /chatter [std_msgs/msg/String]", "publisher node : talker"} <= lines
    assert any(line.startswith("compatibility status : Best effort publisher") for line in lines)


@pytest.mark.thorough
def test_what_does_not_fit_fails_the_checks(ros2: Ros2, node: Node) -> None:
    node.create_publisher(String, "/chatter", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))
    node.create_subscription(String, "/chatter", lambda _: None, 1)
    said = ros2("doctor")
    assert said.returncode == 1
    assert "1 check(s) failed" in said.stdout


def test_hello_tells_which_machines_are_heard(node: Node, started: Callable[..., Running]) -> None:
    publisher = node.create_publisher(String, "/canyouhearme", 10)
    greeting = started("doctor", "hello", "-pp", "0.2")

    def is_heard() -> bool:
        publisher.publish(String(data="hello, it's me elsewhere"))
        return re.search(r"^ {16}elsewhere +\d+ *$", greeting.output, re.MULTILINE) is not None

    until(is_heard, "the other machine")
    assert greeting.output.startswith(
        "MULTIMACHINE COMMUNICATION SUMMARY\nTopic: /canyouhearme, Published Msg Count: "
    )
    assert greeting.end() == 2


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
