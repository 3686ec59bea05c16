"""Publish numbered messages (std_msgs/Int64) at a rate; for each number read, so many, counted from 0.

Each message is due at its own multiple of the period, so that a late one does not delay the others.
"""

import contextlib
import json
import sys
import time

import rclpy
from rclpy.publisher import Publisher
from std_msgs.msg import Int64


def send(publisher: Publisher, count: int, rate: float) -> float:
    """Publish `count` messages at `rate` (Hz); return how long that took in s."""
    begin = time.monotonic()
    for number in range(count):
        time.sleep(max(0.0, begin + number / rate - time.monotonic()))
        publisher.publish(Int64(data=number))
    return time.monotonic() - begin


def main() -> None:
    """Publish on a topic, at a rate in Hz, until Ctrl-C or the end of the input."""
    topic, rate = sys.argv[1], float(sys.argv[2])
    rclpy.init()
    node = rclpy.create_node("benchmark_numbers")
    publisher = node.create_publisher(Int64, topic, 10)
    with contextlib.suppress(KeyboardInterrupt):
        for line in sys.stdin:
            seconds = send(publisher, int(line), rate)
            print(json.dumps(seconds), flush=True)
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
