"""The topic `robot/state`: its quality of service, and how a node follows it."""

from collections.abc import Callable

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.event_handler import QoSSubscriptionMatchedInfo, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from robot_controller.robot_state import State, parse_state

STATE_TOPIC = "robot/state"
# The last state is kept for those who come late.
STATE_QOS = QoSProfile(
    depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)
PATIENCE = 5.0  # s; finding each other takes two processes up to 3 s


class StateListener:
    """Follows `robot/state` for a node, and logs when nobody or more than one publishes it.

    Attributes:
        state: the robot's state; None while nobody publishes it, or after a word that is not
            a state.
    """

    def __init__(self, node: Node, on_change: Callable[[], None] = lambda: None) -> None:
        """Subscribe.

        Args:
            node: the node that wants to know.
            on_change: called after each change of `state`, in the node's executor.
        """
        self.state: State | None = None
        self._logger = node.get_logger()
        self._on_change = on_change
        self._publishers = 0
        self._heard: State | None = None
        self._subscription = node.create_subscription(
            String,
            STATE_TOPIC,
            self._hear,
            STATE_QOS,
            event_callbacks=SubscriptionEventCallbacks(matched=self._count_publishers),
        )
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._patience = node.create_timer(PATIENCE, self._lose_patience, clock=steady)

    def _hear(self, message: String) -> None:
        try:
            self._heard = parse_state(message.data)
        except ValueError as error:
            self._heard = None
            self._logger.warning(f"Refused a state: {error}.")
        self._update()

    def _count_publishers(self, info: QoSSubscriptionMatchedInfo) -> None:
        self._publishers = info.current_count
        self._patience.cancel()
        topic = self._subscription.topic_name
        if self._publishers == 0:
            self._heard = None
            self._logger.warning(f"Nobody publishes {topic} any more: the state is unknown.")
        elif self._publishers > 1:
            self._logger.warning(
                f"{topic} has {self._publishers} publishers: stop all but one "
                "(one that was killed is forgotten within 20 s)."
            )
        else:
            self._logger.info(f"{topic} has a publisher.")
        self._update()

    def _lose_patience(self) -> None:
        self._patience.cancel()
        self._logger.warning(
            f"Nobody publishes {self._subscription.topic_name}: is command_subscriber running?"
        )

    def _update(self) -> None:
        # A word of a publisher that is gone does not count: it may arrive after its end is known.
        state = self._heard if self._publishers else None
        if state is not self.state:
            self.state = state
            self._on_change()
