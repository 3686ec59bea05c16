"""Publish numbered messages at a rate; for each number read, so many, counted from 0.

Each message is due at its own multiple of the period, so that a late one does not delay the others.
"""

import contextlib
import json
import sys
import time
from collections.abc import Callable
from typing import Any

import rclpy
from geometry_msgs.msg import Twist
from rclpy.publisher import Publisher
from std_msgs.msg import Int64


def twist(number: int) -> Twist:
    """Return a command whose speed in µm/s is one more than the number."""
    message = Twist()
    message.linear.x = (number + 1) * 1e-6
    return message


MESSAGES: dict[str, tuple[type, Callable[[int], Any]]] = {
    "Int64": (Int64, lambda number: Int64(data=number)),
    "Twist": (Twist, twist),
}


def send(publisher: Publisher, make: Callable[[int], Any], count: int, rate: float) -> float:
    """Publish `count` messages at `rate` (Hz); return how long that took in s."""
    begin = time.monotonic()
    for number in range(count):
        time.sleep(max(0.0, begin + number / rate - time.monotonic()))
        publisher.publish(make(number))
    return time.monotonic() - begin


def main() -> None:
    """Publish on a topic, at a rate in Hz, a type that may be named, until Ctrl-C or the end of the input."""
    topic, rate = sys.argv[1], float(sys.argv[2])
    kind, make = MESSAGES[sys.argv[3] if len(sys.argv) > 3 else "Int64"]
    rclpy.init()
    node = rclpy.create_node("benchmark_numbers")
    publisher = node.create_publisher(kind, topic, 10)
    with contextlib.suppress(KeyboardInterrupt):
        for line in sys.stdin:
            seconds = send(publisher, make, int(line), rate)
            print(json.dumps(seconds), flush=True)
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
