"""The node that drives the robot."""

from typing import Any

from geometry_msgs.msg import Twist
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter

from robot_controller.name_watch import NameWatch
from robot_controller.number_parameters import Number, declare_numbers
from robot_controller.running import run
from robot_controller.state_topic import StateListener
from robot_controller.velocity import STANDSTILL, Velocity, velocity_in

PARAMETERS = (
    Number("period", 0.1, 0.001, 10.0, "s", "Time between two messages on cmd_vel"),
    Number("linear_speed", 0.5, -5.0, 5.0, "m/s", "Speed forward while running"),
    Number("angular_speed", 0.2, -10.0, 10.0, "rad/s", "Turning to the left while running"),
)
FAREWELL_TIMEOUT = Duration(seconds=0.3)


class VelocityPublisher(Node):
    """Publishes the robot's velocity: the set one while running, zero otherwise.

    Topic names are relative: `/cmd_vel` in the root namespace, `/anna/cmd_vel` in `/anna`.
    While nobody tells the state, and as its last word, it publishes zero.

    Publishes:
        cmd_vel (geometry_msgs/Twist): linear.x in m/s and angular.z in rad/s, every `period`
            and at once when the state changes.

    Subscribes:
        robot/state (std_msgs/String): idle, running or stopped; transient local.

    Parameters:
        period (s, 0.1): time between two messages.
        linear_speed (m/s, 0.5): speed forward while running.
        angular_speed (rad/s, 0.2): turning to the left while running.
    """

    def __init__(self, **kwargs: Any) -> None:
        """Make the node; the arguments go to `rclpy.node.Node`."""
        super().__init__("velocity_publisher", **kwargs)
        self._is_ending = False
        declare_numbers(self, PARAMETERS)
        self._publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self._state_listener = StateListener(self, self._drive)
        self._timer = self.create_timer(self._number("period"), self._drive)
        self.add_post_set_parameters_callback(self._follow_period)
        self._name_watch = NameWatch(self)

    def destroy_node(self) -> None:
        """Publish one zero, see that it arrives, and destroy the node."""
        if self.context.ok() and not self._is_ending:
            # From here on silent, though another thread may still spin the node.
            self._is_ending = True
            self._publish(STANDSTILL)
            self._publisher.wait_for_all_acked(FAREWELL_TIMEOUT)
        super().destroy_node()

    def _drive(self) -> None:
        if self._is_ending:
            return
        cruise = Velocity(self._number("linear_speed"), self._number("angular_speed"))
        self._publish(velocity_in(self._state_listener.state, cruise))

    def _publish(self, velocity: Velocity) -> None:
        twist = Twist()
        twist.linear.x, twist.angular.z = velocity
        self._publisher.publish(twist)

    def _number(self, name: str) -> float:
        return float(self.get_parameter(name).value)

    def _follow_period(self, parameters: list[Parameter]) -> None:
        for parameter in parameters:
            if parameter.name == "period":
                self.destroy_timer(self._timer)
                self._timer = self.create_timer(parameter.value, self._drive)


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or SIGTERM."""
    run(VelocityPublisher, args)


if __name__ == "__main__":
    main()
