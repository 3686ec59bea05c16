"""A session without ROS, for what the widgets compute.

A real session costs a ROS context and graph discovery, and cannot be made to say "two listeners" at once;
`tests/ros/test_widgets_live.py` has the widgets at a real one.
"""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from ros2lab.executor import NodeError
from ros2lab.session import LabSession


class StandInNode:
    """Keeps callbacks by topic, so that a test can be the publisher."""

    def __init__(self) -> None:
        self.callbacks: dict[str, list[Callable[..., None]]] = {}
        self.publishers: dict[str, list[Any]] = {}
        self.nodes = ["ros2lab"]
        self._requested: dict[str, list[Any]] = {}

    def get_fully_qualified_name(self) -> str:
        return "/ros2lab"

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return [(name, "/") for name in self.nodes]

    def get_topic_names_and_types(self) -> list[tuple[str, list[str]]]:
        used = {topic for topic, callbacks in self.callbacks.items() if callbacks} | set(self.publishers)
        return [(topic, []) for topic in sorted(used)]

    def get_subscriptions_info_by_topic(self, topic: str) -> list[Any]:
        return [_info("ros2lab", qos) for qos in self._requested.get(topic, [])]

    def create_subscription(self, _: type, topic: str, callback: Callable[..., None], qos: Any) -> Any:
        self.callbacks.setdefault(topic, []).append(callback)
        self._requested.setdefault(topic, []).append(qos)
        return SimpleNamespace(topic=topic, callback=callback, qos=qos)

    def destroy_subscription(self, subscription: Any) -> None:
        self.callbacks[subscription.topic].remove(subscription.callback)
        self._requested[subscription.topic].remove(subscription.qos)

    def create_publisher(self, _: type, topic: str, __: Any) -> Any:
        return SimpleNamespace(topic=topic, get_subscription_count=lambda: 0)

    def destroy_publisher(self, _: Any) -> None:
        pass

    def resolve_topic_name(self, topic: str) -> str:
        return topic

    def count_publishers(self, topic: str) -> int:
        return len(self.publishers.get(topic, []))

    def get_publishers_info_by_topic(self, topic: str) -> list[Any]:
        return [_info("talker", qos) for qos in self.publishers.get(topic, [])]

    def receive(self, topic: str, message: Any, published: int = 0) -> None:
        """Have a message come that was published then, in ns."""
        for callback in self.callbacks[topic]:
            callback(message, {"source_timestamp": published})


def _info(node: str, qos: Any) -> Any:
    """Return an end as rclpy does; all topics are of texts."""
    return SimpleNamespace(
        node_name=node, node_namespace="/", topic_type="std_msgs/msg/String", qos_profile=qos
    )


class StandInSession(LabSession):
    """Takes a session's place; what it is told to publish is in `published`."""

    def __init__(self) -> None:
        self.node = StandInNode()
        self.listeners = 0
        self.published: list[tuple[str, Any]] = []
        self.raised: list[NodeError] = []
        self._callbacks: list[Callable[[], None]] = []
        self._is_closed = False

    @property
    def is_closed(self) -> bool:
        return self._is_closed

    @property
    def errors(self) -> tuple[NodeError, ...]:
        return tuple(self.raised)

    def subscribers(self, _: str) -> int:
        return self.listeners

    def publish(self, topic: str, message: Any) -> None:
        self.published.append((topic, message))

    def on_close(self, callback: Callable[[], None]) -> None:
        if self._is_closed:
            raise RuntimeError("This session is closed; make a new one with LabSession().")
        self._callbacks.append(callback)

    def close(self) -> None:
        self._is_closed = True
        while self._callbacks:
            self._callbacks.pop()()
