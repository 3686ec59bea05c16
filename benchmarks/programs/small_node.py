"""A node with a publisher and a subscription, which says when it is there, until Ctrl-C."""

import contextlib
import json
import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String


def main() -> None:
    """Run the node whose number is the argument."""
    number = sys.argv[1]
    rclpy.init()
    node = rclpy.create_node(f"small_{number}")
    node.create_publisher(String, f"/said_{number}", 10)
    node.create_subscription(String, f"/heard_{number}", lambda _: None, 10)
    print(json.dumps("ready"), flush=True)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
