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
        self.nodes: list[tuple[str, str]] = []  # name and namespace of each other node

    def create_subscription(self, _: type, topic: str, callback: Callable[..., None], __: Any) -> Any:
        self.callbacks.setdefault(topic, []).append(callback)
        return SimpleNamespace(topic=topic, callback=callback)

    def destroy_subscription(self, subscription: Any) -> None:
        self.callbacks[subscription.topic].remove(subscription.callback)

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
        return [SimpleNamespace(qos_profile=qos) for qos in self.publishers.get(topic, [])]

    def receive(self, topic: str, message: Any, published: int = 0) -> None:
        """Have a message come that was published then, in ns."""
        for callback in self.callbacks[topic]:
            callback(message, {"source_timestamp": published})


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
