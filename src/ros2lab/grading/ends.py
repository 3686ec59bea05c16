"""What the graph tells of a topic's ends: whose they are, and what they can receive."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from rclpy._rclpy_pybind11 import rclpy_get_publishers_info_by_topic, rclpy_get_subscriptions_info_by_topic
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy


def publishers(node: Node, topic: str) -> list[SimpleNamespace]:
    """Return the publishers of a topic, as a node tells of them, but in a third of its time.

    Args:
        node: that asks.
        topic: in full.

    Returns:
        Of each what `TopicEndpointInfo` has, as rclpy's C++ tells it.
    """
    return _infos(node, topic, rclpy_get_publishers_info_by_topic)


def subscriptions(node: Node, topic: str) -> list[SimpleNamespace]:
    """Return the subscriptions of a topic, as `publishers` does its publishers."""
    return _infos(node, topic, rclpy_get_subscriptions_info_by_topic)


def _infos(node: Node, topic: str, ask: Callable[..., list[dict[str, Any]]]) -> list[SimpleNamespace]:
    with node.handle:
        return [SimpleNamespace(**info) for info in ask(node.handle, topic, False)]


def participant(info: Any) -> bytes:
    """Return what all ends of one process have in common: the participant's part of their 24 bytes."""
    return bytes(info.endpoint_gid[:12])


def discovery_ports(domain: int) -> set[int]:
    """Return the UDP ports on which participants of a domain listen for others (DDSI-RTPS 2.5, 9.6.2.3)."""
    ports = range(7400 + 250 * domain + 10, 7400 + 250 * domain + 250, 2)
    lines = Path("/proc/net/udp").read_text().splitlines()[1:]
    return {int(line.split()[1].rpartition(":")[2], 16) for line in lines}.intersection(ports)


def node_name(info: Any) -> str:
    """Return the node whose end this is, with its namespace."""
    return f"{info.node_namespace.rstrip('/')}/{info.node_name}"


def add_types(ends: dict[str, dict[str, list[str]]], topic: str, infos: Iterable[Any]) -> None:
    """Add the types of a topic's ends to those of each node, as far as it is known whose they are.

    A hidden node, as each `ros2 topic` has one, is nobody's work; its name begins as that of an unknown one does.
    """
    for info in infos:
        if not info.node_name.startswith("_"):
            types = ends.setdefault(topic, {}).setdefault(node_name(info), [])
            if info.topic_type not in types:
                types.append(info.topic_type)


def quality(role: str, info: Any) -> str:
    """Return an end's role, reliability and durability in words."""
    reliability = ReliabilityPolicy(info.qos_profile["reliability"])
    durability = DurabilityPolicy(info.qos_profile["durability"])
    return f"{role} {reliability.name.lower()} {durability.name.lower()}"
