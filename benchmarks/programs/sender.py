"""Publish, for each number read, a Twist with that linear x; print the time just before.

Bare rclpy, and nothing that could be left out: the floor of what a message can cost.
"""

import contextlib
import json
import sys
import time

import rclpy
from geometry_msgs.msg import Twist


def main() -> None:
    """Publish until Ctrl-C, or the end of the input."""
    rclpy.init()
    node = rclpy.create_node("benchmark_sender")
    publisher = node.create_publisher(Twist, sys.argv[1], 10)
    with contextlib.suppress(KeyboardInterrupt):
        for line in sys.stdin:
            twist = Twist()
            twist.linear.x = float(line)
            sent = time.monotonic()
            publisher.publish(twist)
            print(json.dumps(sent), flush=True)
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
