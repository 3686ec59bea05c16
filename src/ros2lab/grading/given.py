"""What nodes wait for and nobody in a hand-in brings: messages, requests and responses of default values.

What is a flag in them is given both ways, one after the other: with one of them most gates open that have one.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Collection, Iterator
from typing import Any

from rclpy._rclpy_pybind11 import NodeNameNonExistentError

from ros2lab.every_node import HIDDEN_TOPICS
from ros2lab.grading.watch import NODES, OF_EVERY_NODE, TOPICS, Watch
from ros2lab.observed_domain import LATCHED, UNTOLD
from ros2lab.topics import find_type


class Given:
    """Gives the nodes of a run what they may wait for.

    Args:
        watch: of the run.
        kept: topics and services of the assignment, which have their own stimuli.
        flags: what the flags in messages and responses are.

    Attributes:
        names: the topics and services on which something was given.
    """

    def __init__(self, watch: Watch, kept: Collection[str], *, flags: bool) -> None:
        self._flags = flags
        self.names: set[str] = set()
        self._watch = watch
        self._kept = {*kept, *HIDDEN_TOPICS}
        self._publishers: dict[str, Any] = {}
        self._clients: dict[str, Any] = {}
        self._services: dict[str, Any] = {}

    def give(self) -> None:
        """Publish on each topic that is only subscribed to, call each service, and provide each that is called."""
        for do, name, type_name in [*self._wanted()]:
            with contextlib.suppress(Exception):  # rclpy raises many kinds for types and names it cannot use
                do(name, find_type(type_name))

    def _wanted(self) -> Iterator[tuple[Callable[[str, Any], None], str, str]]:
        """Yield what is to be done, with the name of a topic or a service and its type."""
        kept = {*self._kept, self._watch.command_topic()}
        for topic, nodes in sorted(self._watch.subscribes.items())[:TOPICS]:
            if topic not in kept and topic not in self._watch.publishes:
                yield self._publish, topic, next(iter(nodes.values()))[0]
        node = self._watch.node
        for name in sorted(set(self._watch.nodes()))[:NODES]:
            space, _, base = name.rpartition("/")
            with contextlib.suppress(NodeNameNonExistentError):  # it has just left
                for service, kind in self._own(node.get_service_names_and_types_by_node(base, space or "/")):
                    yield self._call, service, kind
                for service, kind in self._own(node.get_client_names_and_types_by_node(base, space or "/")):
                    yield self._provide, service, kind

    def _own(self, found: Any) -> list[tuple[str, str]]:
        """Return the services that are neither the assignment's nor every node's, with their types."""
        return [
            (service, types[0])
            for service, types in found[: 4 * TOPICS]
            if service not in self._kept and not types[0].startswith(OF_EVERY_NODE)
        ]

    def _publish(self, topic: str, message: Any) -> None:
        if topic not in self._publishers:
            self._publishers[topic] = self._watch.node.create_publisher(
                message, topic, LATCHED, event_callbacks=UNTOLD
            )
            self.names.add(topic)
        self._publishers[topic].publish(_flagged(message(), self._flags))

    def _call(self, service: str, kind: Any) -> None:
        """Call a service once, as soon as it is there; a flag of the request is set, for false often means to stop."""
        if service in self._services:
            return
        if service not in self._clients:
            self._clients[service] = self._watch.node.create_client(kind, service)
        if service not in self.names and self._clients[service].service_is_ready():
            self._clients[service].call_async(_flagged(kind.Request(), True))
            self.names.add(service)

    def _provide(self, service: str, kind: Any) -> None:
        is_there = service in self._clients or service in self._services
        if not is_there and not self._watch.node.count_services(service):
            self._services[service] = self._watch.node.create_service(
                kind, service, lambda _, response: _flagged(response, self._flags)
            )
            self.names.add(service)


def _flagged(message: Any, flags: bool) -> Any:
    """Return a message with its flags set, or not."""
    for name, field in message.get_fields_and_field_types().items():
        if field == "boolean":
            setattr(message, name, flags)
    return message
