"""The node that obeys the commands."""

from typing import Any

from rclpy.node import Node
from std_msgs.msg import String

from robot_controller.name_watch import NameWatch
from robot_controller.robot_state import State, effect_of, parse_command
from robot_controller.running import run
from robot_controller.state_topic import STATE_QOS, STATE_TOPIC


class CommandSubscriber(Node):
    """Keeps the robot's state, which the commands change: idle -> running -> stopped -> idle.

    Topic names are relative: `/robot/command` in the root namespace, and
    `/anna/robot/command` in `/anna`.

    Subscribes:
        robot/command (std_msgs/String): start, stop or reset; anything else is refused
            with a warning.

    Publishes:
        robot/state (std_msgs/String): idle, running or stopped, at start-up and at each change;
            reliable and transient local, so that a late node hears the last one.

    It has no parameters.
    """

    def __init__(self, **kwargs: Any) -> None:
        """Make the node; the arguments go to `rclpy.node.Node`."""
        super().__init__("command_subscriber", **kwargs)
        self._state = State.IDLE
        self._publisher = self.create_publisher(String, STATE_TOPIC, STATE_QOS)
        # Reliable and volatile: that hears every kind of publisher.
        self._subscription = self.create_subscription(String, "robot/command", self._obey, 10)
        self._name_watch = NameWatch(self)
        self._publish_state()

    def _obey(self, message: String) -> None:
        try:
            command = parse_command(message.data)
        except ValueError as error:
            self.get_logger().warning(f"Refused a command: {error}.")
            return
        effect = effect_of(command, self._state)
        if effect.after is not self._state:
            self._state = effect.after
            self._publish_state()  # before the log line, for which the robot should not wait
        self.get_logger().info(f"Received '{command.value}': {effect}")

    def _publish_state(self) -> None:
        self._publisher.publish(String(data=self._state.value))


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or SIGTERM."""
    run(CommandSubscriber, args)


if __name__ == "__main__":
    main()
