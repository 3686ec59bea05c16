"""The robot view at a real session: it drives as it is told, and says where it is."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Twist
from rclpy.node import Node

from deadlines import DEADLINE
from ros2lab.session import LabSession
from ros2lab.topics import TopicLog
from ros2lab.widgets import RobotView


def twist(linear: float, angular: float = 0.0) -> Twist:
    message = Twist()
    message.linear.x, message.angular.z = linear, angular
    return message


class Driver(Node):
    """Drives on a circle, ten commands a second."""

    def __init__(self, topic: str = "/cmd_vel") -> None:
        super().__init__("driver")
        publisher = self.create_publisher(Twist, topic, 10)
        self.create_timer(0.1, lambda: publisher.publish(twist(0.5, 0.5)))


def wait_for_publishers(session: LabSession, topic: str, count: int) -> None:
    """Wait until the graph shows so many; ROS sends no event of it."""
    deadline = time.monotonic() + DEADLINE
    while session.node.count_publishers(topic) != count:
        assert time.monotonic() < deadline
        time.sleep(0.01)


def heading_of(odometry: Any) -> float:
    turn = odometry.pose.pose.orientation
    return 2 * math.atan2(turn.z, turn.w)


def test_the_odometry_tells_the_circle_on_which_the_robot_drives(session: LabSession) -> None:
    view = RobotView(session, start=(1.0, 2.0, math.pi / 2))
    odometry = session.log("/odom", "nav_msgs/msg/Odometry")
    session.run(Driver)
    driving = odometry.wait_until(lambda message: message.twist.twist.linear.x > 0, DEADLINE).message
    assert driving.twist.twist.angular.z == 0.5
    assert (driving.header.frame_id, driving.child_frame_id) == ("odom", "base_link")
    odometry.wait_until(lambda message: heading_of(message) > math.pi / 2 + 1.0, DEADLINE)
    for sample in odometry.samples():
        position, heading = sample.message.pose.pose.position, heading_of(sample.message)
        # The circle's middle lies 1 m to the left of where the robot began.
        assert math.hypot(position.x - 0.0, position.y - 2.0) == pytest.approx(1.0)
        assert (position.x, position.y) == pytest.approx((math.sin(heading), 2.0 - math.cos(heading)))
    assert view.pose.heading > math.pi / 2 + 1.0


def test_two_robots_drive_and_report_each_on_their_own_topics(session: LabSession) -> None:
    view = RobotView(session, topic=["/robin/cmd_vel", "/wren/cmd_vel"], start=[(0, 0, 0), (0, 5, 0)])
    odometry = session.log("/robin/odom", "nav_msgs/msg/Odometry")
    session.publish("/robin/cmd_vel", twist(1.0))
    message = odometry.wait_until(lambda message: message.pose.pose.position.x > 0.2, DEADLINE).message
    assert message.header.frame_id == "robin/odom"
    assert view.poses[1] == (0, 5, 0)


def test_no_command_of_a_flood_is_lost(session: LabSession) -> None:
    """Two thousand in bursts of a hundred, each with another turn: the heading is what all of them add up to."""
    view = RobotView(session)
    log = view.topic_logs[0]
    publisher = session.node.create_publisher(Twist, "/cmd_vel", 1000)
    source = TopicLog(session.node, "/cmd_vel", Twist)  # reliable: it knows what was published
    for begin in range(0, 2000, 100):
        for number in range(begin, begin + 100):
            publisher.publish(twist(0.0, float(number % 7)))
        source.wait_for(begin + 100, DEADLINE)
    log.wait_for(2000, DEADLINE)
    times = np.array([sample.time for sample in log.samples()])
    turns = np.array([sample.message.angular.z for sample in log.samples()])
    # Each holds until the next one, and for a second at most, as on a machine that is too busy to send the next burst.
    held = np.minimum(np.diff(times, append=np.inf), 1.0)
    expected = pytest.approx(float((held * turns).sum()))
    odometry = session.log("/odom", "nav_msgs/msg/Odometry")
    odometry.wait_until(lambda message: view.pose.heading == expected, DEADLINE)
    odometry.wait_until(lambda message: message.twist.twist.angular.z == 0.0, DEADLINE)
    assert view.pose.heading == expected
    assert log.count == 2000


def test_a_closed_view_leaves_no_topic_behind(session: LabSession) -> None:
    view = RobotView(session)
    wait_for_publishers(session, "/odom", 1)
    view.close()
    view.close()
    wait_for_publishers(session, "/odom", 0)
