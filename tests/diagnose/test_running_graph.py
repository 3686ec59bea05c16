"""Faults that only the running nodes show."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import pytest
import rclpy
from geometry_msgs.msg import Twist
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from deadlines import DEADLINE
from ros2lab.diagnose import Finding, of_graph


@pytest.fixture
def make_node(domain_id: int) -> Iterator[Callable[[str], Node]]:
    """Return what makes nodes, each with a context of its own, as if it were a process."""
    contexts: list[Context] = []
    nodes: list[Node] = []

    def make(name: str) -> Node:
        context = Context()
        rclpy.init(context=context, domain_id=domain_id)
        contexts.append(context)
        nodes.append(Node(name, context=context, start_parameter_services=False, enable_rosout=False))
        return nodes[-1]

    yield make
    for node, context in zip(nodes, contexts, strict=True):
        node.destroy_node()
        context.try_shutdown()


def wait(node: Node, topic: str, publishers: int, listeners: int) -> list[Finding]:
    """Return what is found once the graph is as it should be."""
    end = time.monotonic() + DEADLINE
    while (node.count_publishers(topic), node.count_subscribers(topic)) != (publishers, listeners):
        assert time.monotonic() < end, "the graph does not come to be"
        time.sleep(0.01)
    return of_graph(node)


def test_a_right_graph_raises_no_alarm(make_node: Callable[[str], Node]) -> None:
    talker, listener = make_node("talker"), make_node("listener")
    talker.create_publisher(String, "/robot/status", 10)
    listener.create_subscription(String, "/robot/status", print, 10)
    listener.create_subscription(String, "/robot/state", print, 10)
    assert wait(listener, "/robot/status", 1, 1) == []


@pytest.mark.parametrize("topic", ["/robot/comand", "/cmd_vel2", "/Robot/Status"])
def test_a_name_nearly_right_is_seen(make_node: Callable[[str], Node], topic: str) -> None:
    node = make_node("talker")
    node.create_publisher(String, topic, 10)
    (finding,) = wait(node, topic, 1, 0)
    assert finding.code == "topic-near-miss"
    assert topic in finding.cause


def test_two_names_nearly_alike_are_seen(make_node: Callable[[str], Node]) -> None:
    talker, listener = make_node("talker"), make_node("listener")
    talker.create_publisher(String, "/chatter", 10)
    listener.create_subscription(String, "/chater", print, 10)
    wait(listener, "/chatter", 1, 0)
    findings = wait(listener, "/chater", 0, 1)
    assert {finding.code for finding in findings} == {"topic-near-miss"}


def test_another_type_is_seen(make_node: Callable[[str], Node]) -> None:
    talker, listener = make_node("talker"), make_node("listener")
    talker.create_publisher(String, "/cmd_vel", 10)
    listener.create_subscription(Twist, "/cmd_vel", print, 10)
    (finding,) = wait(listener, "/cmd_vel", 1, 1)
    assert finding.code == "topic-type"
    assert "std_msgs/msg/String" in finding.cause


def test_another_quality_of_service_is_seen(make_node: Callable[[str], Node]) -> None:
    talker, listener = make_node("talker"), make_node("listener")
    talker.create_publisher(String, "/robot/state", 10)
    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    listener.create_subscription(String, "/robot/state", print, qos)
    (finding,) = wait(listener, "/robot/state", 1, 1)
    assert finding.code == "qos-mismatch"


def test_two_nodes_of_one_name_are_seen(make_node: Callable[[str], Node]) -> None:
    one, other = make_node("talker"), make_node("talker")
    one.create_publisher(String, "/news", 10)
    other.create_publisher(String, "/news", 10)
    end = time.monotonic() + DEADLINE
    while one.get_node_names().count("talker") < 2:
        assert time.monotonic() < end, "the second node is not seen"
        time.sleep(0.01)
    assert [finding.code for finding in wait(one, "/news", 2, 0)] == ["name-twice"]
