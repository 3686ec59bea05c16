"""A real action server, for the tests of `ros2 action`: Fibonacci's numbers, up to as many as a goal says.

A goal of a negative number is aborted, one of too many is rejected, and one of `ENDLESS` ends when it is canceled.
Run as a process of its own; the line "ready" says that it is there.
"""

from __future__ import annotations

import threading
import time
from typing import Any

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from test_msgs.action import Fibonacci

MOST, ENDLESS = 10, 7


def main() -> None:
    """Serve until told to end."""
    rclpy.init()
    node = rclpy.create_node("counter")
    canceled = threading.Event()

    def accept(goal: Any) -> Any:
        return GoalResponse.REJECT if goal.order > MOST else GoalResponse.ACCEPT

    def cancel(_: Any) -> Any:
        canceled.set()
        return CancelResponse.ACCEPT

    def count(handle: Any) -> Any:
        feedback = Fibonacci.Feedback(sequence=[0, 1])
        for _ in range(1, handle.request.order):
            feedback.sequence.append(sum(feedback.sequence[-2:]))
            handle.publish_feedback(feedback)
        if handle.request.order == ENDLESS:
            canceled.wait()
            while not handle.is_cancel_requested:  # it is once the answer to the request has gone
                time.sleep(0.01)
            handle.canceled()
        elif handle.request.order < 0:
            handle.abort()
        else:
            handle.succeed()
        return Fibonacci.Result(sequence=feedback.sequence)

    ActionServer(node, Fibonacci, "fibonacci", count, goal_callback=accept, cancel_callback=cancel)
    executor = MultiThreadedExecutor(2)
    executor.add_node(node)
    print("ready", flush=True)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
