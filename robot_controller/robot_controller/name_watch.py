"""Notice when a node has been started twice."""

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node

LOOK_PERIOD = 1.0  # s


class NameWatch:
    """Says in a node's log that another node bears its name, and when that is over."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._is_alone = True
        # A steady clock: also when the robot's time is simulated and stands still.
        node.create_timer(LOOK_PERIOD, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _look(self) -> None:
        name = self._node.get_fully_qualified_name()
        is_alone = _nodes_named(name, self._node) < 2
        if is_alone == self._is_alone:
            return
        self._is_alone = is_alone
        if is_alone:
            self._node.get_logger().info(f"This is the only node named {name} again.")
        else:
            self._node.get_logger().warning(
                f"Another node is named {name} too, so what they publish comes twice: "
                "stop one of them (one that was killed is forgotten within 20 s)."
            )


def _nodes_named(full_name: str, node: Node) -> int:
    nodes = node.get_node_names_and_namespaces()
    return sum(f"{namespace.rstrip('/')}/{name}" == full_name for name, namespace in nodes)
