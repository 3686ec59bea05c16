"""The participants by which an observer joins a domain: one holds one type of a topic, and nodes may use several."""

from __future__ import annotations

import contextlib
import secrets

from rclpy.context import Context
from rclpy.node import Node

from ros2lab.grading.watching import ends
from ros2lab.listener import Listener


class Participants(Listener):
    """The observer's own participant, and more where a topic has several types; listens by all of them.

    Args:
        node: the observer's node.
        context: of the node.
        domain: the domain's number.

    Attributes:
        nodes: the observer's, and one for each further participant.
        prefixes: what the ends of each of them have in common.
    """

    def __init__(self, node: Node, context: Context, domain: int) -> None:
        super().__init__(node, context)
        self._domain = domain
        self._listeners = list[Listener]()
        self._types: list[dict[str, str]] = [{}]  # by topic, the type that each of them holds
        self._open = contextlib.ExitStack()
        self._missed = set[tuple[Node, bytes]]()  # ends that a participant is not expected to meet any more
        self.prefixes: set[bytes] = set()

    def holding(self, topic: str, type_name: str) -> Node:
        """Return the node for an end of a topic, in a participant that holds no other type of it."""
        for node, types in zip(self.nodes, self._types, strict=True):
            if types.setdefault(topic, type_name) == type_name:
                return node
        self._types.append({topic: type_name})
        return self._join()

    def lags(self) -> bool:
        """Return whether one of them has still to meet a publisher of its topics that the observer's own has met."""
        return bool(self._unmet())

    def give_up(self) -> None:
        """Wait no longer for those that are still to be met: their programs may have been killed before one joined."""
        self._missed |= self._unmet()

    def _unmet(self) -> set[tuple[Node, bytes]]:
        return {
            (node, end)
            for node, types in zip(self.nodes[1:], self._types[1:], strict=True)
            for topic in types
            for end in _ends(self.nodes[0], topic) - _ends(node, topic)
        } - self._missed

    def _join(self) -> Node:
        context = Context()
        context.init(args=["--ros-args", "--disable-stdout-logs"], domain_id=self._domain)
        self._open.callback(context.try_shutdown)
        name = f"_observer_{secrets.token_hex(8)}"  # a hidden node
        node = Node(name, context=context, start_parameter_services=False)
        self._open.callback(node.destroy_node)
        listener = Listener(node, context)
        self._open.callback(listener.close)
        own = [info for info in ends.publishers(node, "/parameter_events") if info.node_name == name]
        self.prefixes |= {*map(ends.participant, own)}
        self.nodes.append(node)
        self._listeners.append(listener)
        return node

    def listen(self, seconds: float) -> None:
        """Wait as the observer does, and hand on what has come to the others meanwhile."""
        super().listen(seconds)
        for listener in self._listeners:
            listener.listen(0.0)

    def close(self) -> None:
        """Leave the domain, except by the observer's own participant. Closing twice does no harm."""
        super().close()
        self._open.close()


def _ends(node: Node, topic: str) -> set[bytes]:
    return {bytes(info.endpoint_gid) for info in ends.publishers(node, topic)}
