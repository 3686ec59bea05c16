"""What the checks of `04_first_node` leave alone, besides the answers in `answers/first_node.yaml`."""

from __future__ import annotations

import os

from rclpy.node import Node
from std_msgs.msg import Int32, String

from ros2lab.checks import first_node
from ros2lab.session import LabSession


class Battery(Node):
    """As the lesson's solution has it."""

    def __init__(self) -> None:
        super().__init__("battery")
        self.charge = 100
        self.publisher = self.create_publisher(Int32, "battery", 10)
        self.create_timer(0.5, self.tell)

    def tell(self) -> None:
        self.publisher.publish(Int32(data=self.charge))
        self.charge -= 1


def test_a_battery_is_checked_beside_a_session(domain_id: int) -> None:
    """The student's own session goes on, and does not receive what the checked node publishes."""
    with LabSession(domain_id=domain_id) as session:
        log = session.log("/battery", Int32)
        own = session.log("/own", String)
        assert first_node.battery(Battery).startswith("Right")
        session.publish("/own", "still here")
        own.wait_for(1)
        assert log.count == 0
    assert os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST"
