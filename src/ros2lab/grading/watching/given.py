"""What nodes wait for and a submission does not provide: messages, requests and responses of default values.

Flags in them are set one way and then the other, which opens most gates. If nodes wait for nothing but a few
flags, these are given in all combinations.
"""

from __future__ import annotations

import contextlib
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator
from typing import Any

from rclpy._rclpy_pybind11 import NodeNameNonExistentError

from ros2lab.every_node import HIDDEN_TOPICS
from ros2lab.grading.watching.watch import NODES, OF_EVERY_NODE, TOPICS, Watch
from ros2lab.observed_domain import LATCHED, UNTOLD
from ros2lab.topics import find_type, type_name

MOST_FLAGS = 3  # that are given in all combinations
MANAGES = "lifecycle_msgs/srv/ChangeState"  # makes a managed node begin
BEGIN = (1, 3)  # configure, activate


class Given:
    """Gives the nodes of a run what they may wait for.

    Args:
        watch: the observer's watch of the run.
        kept: topics and services of the assignment, which have their own stimuli.
        flags: the first value of flags in messages and responses.

    Attributes:
        names: the topics and services on which something was given.
        flags: those of them whose type is a single flag.
        plain: those whose type leaves nothing to choose.
    """

    def __init__(self, watch: Watch, kept: Collection[str], *, flags: bool) -> None:
        self._is_first = flags
        self._turn = 0
        self.names: set[str] = set()
        self.flags: list[str] = []
        self.plain: set[str] = set()
        self._watch = watch
        self._kept = {*kept, *HIDDEN_TOPICS}
        self._publishers: dict[str, Any] = {}
        self._clients: dict[str, Any] = {}
        self._requests: dict[str, list[Any]] = defaultdict(list)
        self._services: dict[str, Any] = {}

    @property
    def turns(self) -> int:
        """The number of combinations in which flags are given."""
        return int(2 ** min(len(self.flags), MOST_FLAGS))

    @property
    def tried(self) -> list[str]:
        """The topics and services that were given every possible value, in every combination with others."""
        is_all = len(self.flags) == 1 or self._turn == self.turns - 1
        return sorted([*self.plain, *(self.flags if is_all and len(self.flags) <= MOST_FLAGS else ())])

    def told(self) -> dict[str, Any]:
        """Return what the grader is told of what was given."""
        return {"given": sorted(self.names), "tried": self.tried}

    def _with_own_stimuli(self) -> set[str]:
        """Return the topics on which nothing is given."""
        return {*self._kept, self._watch.command_topic()}

    def give(self, turn: int | None = None) -> None:
        """Publish on each topic without a publisher, call each service, and provide each that is called.

        Args:
            turn: the number of the combination of flags; None leaves them as they are.
        """
        self._turn = self._turn if turn is None else min(turn, self.turns - 1)
        for do, name, kind in [*self._wanted()]:
            with contextlib.suppress(Exception):  # rclpy raises many kinds for types and names it cannot use
                do(name, find_type(kind))

    def _wanted(self) -> Iterator[tuple[Callable[[str, Any], None], str, str]]:
        """Yield what to do, each with the name of a topic or a service and its type."""
        kept = self._with_own_stimuli()
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
            node = self._watch.holding(topic, type_name(message))
            self._publishers[topic] = node.create_publisher(message, topic, LATCHED, event_callbacks=UNTOLD)
        self._publishers[topic].publish(self._flagged(topic, message()))
        self.names.add(topic)

    def _call(self, service: str, kind: Any) -> None:
        """Call an available service once with each request; flags start as true: false often means stop."""
        if service in self._services:
            return
        if service not in self._clients:
            self._clients[service] = self._watch.node.create_client(kind, service)
        for request in self._made(service, kind):
            if self._clients[service].service_is_ready() and request not in self._requests[service]:
                self._clients[service].call_async(request)
                self._requests[service].append(request)
                self.names.add(service)

    def _made(self, service: str, kind: Any) -> list[Any]:
        """Return the requests that are sent to a service together."""
        if kind != find_type(MANAGES):
            return [self._flagged(service, kind.Request(), is_first=True)]
        requests = [kind.Request() for _ in BEGIN]
        for request, number in zip(requests, BEGIN, strict=True):
            request.transition.id = number
        self.plain.add(service)
        return requests

    def _provide(self, service: str, kind: Any) -> None:
        is_there = service in self._clients or service in self._services
        if not is_there and not self._watch.node.count_services(service):
            self._services[service] = self._watch.node.create_service(
                kind, service, lambda _, response: self._flagged(service, response)
            )
            self.names.add(service)

    def _flagged(self, name: str, message: Any, *, is_first: bool | None = None) -> Any:
        """Set the flags of a message, a request or a response to true or false, and return it."""
        fields = message.get_fields_and_field_types()
        if not fields:
            self.plain.add(name)
        elif [*fields.values()] == ["boolean"] and name not in self.flags:
            self.flags.append(name)
        is_set = self._is_first if is_first is None else is_first
        if name in self.flags:
            is_set ^= bool(self._turn >> self.flags.index(name) & 1)
        for field in (field for field, kind in fields.items() if kind == "boolean"):
            setattr(message, field, is_set)
        return message
