"""One half of the doctor's message test: a process that sends and measures, or one that sends back.

Run by path and not as a module: it must say what is wrong also where the lab itself cannot be imported.
"""

from __future__ import annotations

import json
import statistics
import sys
import time

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.utilities import get_rmw_implementation_identifier
from std_msgs.msg import String

MESSAGES = 100
DISCOVERY_TIMEOUT = 15.0  # s
REPLY_TIMEOUT = 2.0  # s


def main() -> None:
    """Send back (`pong`) or send and measure (`ping`) on topics below the name given."""
    role, topic = sys.argv[1:]
    rclpy.init()
    try:
        ping(topic) if role == "ping" else pong(topic)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


def pong(topic: str) -> None:
    """Send back every message until interrupted."""
    node = rclpy.create_node("ros2lab_doctor_pong")
    publisher = node.create_publisher(String, f"{topic}/pong", 10)
    node.create_subscription(String, f"{topic}/ping", publisher.publish, 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    print("ready", flush=True)
    executor.spin()


def ping(topic: str) -> None:
    """Print, as JSON, how long two processes took to meet and the median time of a message, in s."""
    started = time.monotonic()
    node = rclpy.create_node("ros2lab_doctor_ping")
    publisher = node.create_publisher(String, f"{topic}/ping", 10)
    replies: list[str] = []
    node.create_subscription(String, f"{topic}/pong", lambda message: replies.append(message.data), 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)

    def send(text: str, timeout: float) -> bool:
        publisher.publish(String(data=text))
        deadline = time.monotonic() + timeout
        while text not in replies and time.monotonic() < deadline:
            executor.spin_once(timeout_sec=deadline - time.monotonic())
        return text in replies

    while not send("hello", 0.02):
        if time.monotonic() - started > DISCOVERY_TIMEOUT:
            sys.exit(f"error: two processes did not find each other within {DISCOVERY_TIMEOUT:g} s")
    discovery = time.monotonic() - started

    times = []
    for number in range(MESSAGES):
        sent = time.monotonic()
        if not send(str(number), REPLY_TIMEOUT):
            sys.exit(f"error: message {number + 1} of {MESSAGES} was lost")
        times.append((time.monotonic() - sent) / 2)
        replies.clear()
    middleware = get_rmw_implementation_identifier()
    told = {"discovery_s": discovery, "message_s": statistics.median(times), "middleware": middleware}
    print(json.dumps(told))


if __name__ == "__main__":
    main()
