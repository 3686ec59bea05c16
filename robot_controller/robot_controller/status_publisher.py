"""The node that tells how the robot is."""

import time
from typing import Any

from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import String

from robot_controller.name_watch import NameWatch
from robot_controller.number_parameters import Number, declare_numbers
from robot_controller.running import run
from robot_controller.state_topic import StateListener
from robot_controller.status_line import Status, format_status

PERIOD = Number("period", 2.0, 0.01, 3600.0, "s", "Time between two messages on robot/status")
PARAMETERS = (PERIOD,)


class StatusPublisher(Node):
    """Publishes how the robot is, as one line of `key=value` pairs.

    Topic names are relative: `/robot/status` in the root namespace, and
    `/anna/robot/status` in `/anna`.

    Publishes:
        robot/status (std_msgs/String): `state=running uptime_s=12.0 count=6`, every `period`.

    Subscribes:
        robot/state (std_msgs/String): idle, running or stopped; transient local.

    Parameters:
        period (s, 2.0): time between two messages.
    """

    def __init__(self, **kwargs: Any) -> None:
        """Make the node; the arguments go to `rclpy.node.Node`."""
        super().__init__("status_publisher", **kwargs)
        declare_numbers(self, PARAMETERS)
        self._publisher = self.create_publisher(String, "robot/status", 10)
        self._state_listener = StateListener(self)
        self._timer = self.create_timer(self.get_parameter("period").value, self._publish)
        self.add_post_set_parameters_callback(self._follow_period)
        self._name_watch = NameWatch(self)
        self._started = time.monotonic()
        self._count = 0

    def _publish(self) -> None:
        self._count += 1
        status = Status(self._state_listener.state, time.monotonic() - self._started, self._count)
        self._publisher.publish(String(data=format_status(status)))

    def _follow_period(self, parameters: list[Parameter]) -> None:
        for parameter in parameters:
            if parameter.name == "period":
                self.destroy_timer(self._timer)
                self._timer = self.create_timer(parameter.value, self._publish)


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or SIGTERM."""
    run(StatusPublisher, args)


if __name__ == "__main__":
    main()
