"""A session without ROS, for what the widgets compute.

A real session costs a ROS context and graph discovery, and cannot be made to say "two listeners" at once;
`tests/ros/test_widgets_live.py` has the widgets at a real one.
"""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from rclpy.serialization import serialize_message

from ros2lab.executor import NodeError
from ros2lab.session import LabSession


class StandInNode:
    """Keeps callbacks by topic, so that a test can be the publisher."""

    def __init__(self) -> None:
        self.callbacks: dict[str, list[Callable[..., None]]] = {}
        self.publishers: dict[str, list[Any]] = {}
        self.nodes: list[tuple[str, str]] = []  # name and namespace of each other node
        self._requested: dict[str, list[Any]] = {}
        self.types: dict[str, str] = {}  # of what is published, by topic; texts if it is not said
        self.sent: list[Any] = []  # by publishers of the widgets' own
        self.own_publishers: list[str] = []
        self.is_raw: dict[Callable[..., None], bool] = {}

    def get_fully_qualified_name(self) -> str:
        return "/ros2lab"

    def get_topic_names_and_types(self) -> list[tuple[str, list[str]]]:
        used = {topic for topic, callbacks in self.callbacks.items() if callbacks} | set(self.publishers)
        return [(topic, self._types(topic)) for topic in sorted(used | set(self.types))]

    def get_subscriptions_info_by_topic(self, topic: str) -> list[Any]:
        return [self._info("ros2lab", topic, qos) for qos in self._requested.get(topic, [])]

    def create_subscription(
        self, _: type, topic: str, callback: Callable[..., None], qos: Any, *, raw: bool = False
    ) -> Any:
        self.callbacks.setdefault(topic, []).append(callback)
        self._requested.setdefault(topic, []).append(qos)
        self.is_raw[callback] = raw
        return SimpleNamespace(topic=topic, callback=callback, qos=qos)

    def create_publisher(self, _: type, topic: str, __: Any) -> Any:
        self.own_publishers.append(topic)
        return SimpleNamespace(
            topic=topic,
            publish=self.sent.append,
            wait_for_all_acked=lambda _: True,
            get_subscription_count=lambda: 0,
        )

    def destroy_publisher(self, publisher: Any) -> None:
        self.own_publishers.remove(publisher.topic)

    def destroy_subscription(self, subscription: Any) -> None:
        self.callbacks[subscription.topic].remove(subscription.callback)
        self._requested[subscription.topic].remove(subscription.qos)

    def resolve_topic_name(self, topic: str) -> str:
        return topic

    def get_name(self) -> str:
        return "ros2lab"

    def get_namespace(self) -> str:
        return "/"

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return [(self.get_name(), self.get_namespace()), *self.nodes]

    def count_publishers(self, topic: str) -> int:
        return len(self.publishers.get(topic, []))

    def get_publishers_info_by_topic(self, topic: str) -> list[Any]:
        return [self._info("talker", topic, qos) for qos in self.publishers.get(topic, [])]

    def _types(self, topic: str) -> list[str]:
        return [self.types[topic]] if topic in self.types else []

    def _info(self, node: str, topic: str, qos: Any) -> Any:
        """Return an end as rclpy does."""
        topic_type = self.types.get(topic, "std_msgs/msg/String")
        return SimpleNamespace(node_name=node, node_namespace="/", topic_type=topic_type, qos_profile=qos)

    def receive(self, topic: str, message: Any, published: int = 0) -> None:
        """Have a message come that was published then, in ns."""
        for callback in self.callbacks[topic]:
            taken = serialize_message(message) if self.is_raw[callback] else message
            callback(taken, {"source_timestamp": published})


class StandInSession(LabSession):
    """Takes a session's place; what it is told to publish is in `published`."""

    def __init__(self) -> None:
        self.node = StandInNode()
        self.domain_id = 7
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
