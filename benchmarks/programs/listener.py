"""Print, as a line of JSON, each value of a topic that differs from the one before, with its time.

It knows nothing of the lab: bare rclpy, as the receiving end of whatever is measured.
The value of a Twist is its linear x, that of a String its text.
"""

import json
import sys
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String

TYPES = {"Twist": (Twist, lambda twist: twist.linear.x), "String": (String, lambda string: string.data)}


def main() -> None:
    """Listen to a topic of a type until Ctrl-C."""
    topic, (message_type, value_of) = sys.argv[1], TYPES[sys.argv[2]]
    rclpy.init()
    node = rclpy.create_node("benchmark_listener")
    last = None

    def hear(message: object) -> None:
        nonlocal last
        monotonic, wall = time.monotonic(), time.time()
        if value_of(message) != last:
            last = value_of(message)
            print(json.dumps({"value": last, "monotonic": monotonic, "wall": wall}), flush=True)

    node.create_subscription(message_type, topic, hear, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
