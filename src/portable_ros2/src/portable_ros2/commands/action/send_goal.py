"""`ros2 action send_goal`."""

from __future__ import annotations

import argparse
import math
import signal
import sys
import time
from types import FrameType
from typing import Any

from portable_ros2 import messages
from portable_ros2.commands.action import _actions
from portable_ros2.graph import NODE_NAME_PREFIX, GraphNode
from portable_ros2.verb import Verb

LOOK = 0.1  # s between two looks at whether somebody pressed Ctrl-C
STATUSES = ("UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")


class SendGoalVerb(Verb):
    """Send an action goal."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _actions.add_action_argument(parser, "")
        kind = parser.add_argument(
            "action_type", help="Type of the ROS action (e.g. 'example_interfaces/action/Fibonacci')"
        )
        kind.completer = _actions.complete_type  # type: ignore[attr-defined]
        group = parser.add_mutually_exclusive_group()
        goal = group.add_argument(
            "goal",
            nargs="?",
            default="{}",
            help="Goal request values in YAML format (e.g. '{order: 10}')",
        )
        goal.completer = _actions.complete_goal  # type: ignore[attr-defined]
        group.add_argument("--stdin", action="store_true", help="Read goal from standard input")
        parser.add_argument(
            "-f", "--feedback", action="store_true", help="Echo feedback messages for the goal"
        )
        parser.add_argument(
            "-t",
            "--timeout",
            metavar="N",
            type=_seconds,
            help="Wait for N seconds until server becomes available and goal is completed "
            "(default waits indefinitely)",
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        action_class: Any = _actions.find(args.action_type)
        goal = action_class.Goal()
        text = sys.stdin.read() if args.stdin else args.goal
        if text.strip():
            messages.fill(goal, messages.parse_values(text))
        name = f"{NODE_NAME_PREFIX}_send_goal_{args.action_type.replace('/', '_')}"
        with GraphNode(argparse.Namespace(), name=name) as node:
            from rclpy.action import ActionClient

            client = ActionClient(node.node, action_class, args.action_name)
            try:
                print("Waiting for an action server to become available...")
                if client.wait_for_server(timeout_sec=args.timeout):
                    _send(_Spinning(node), client, goal, args)
                else:
                    print(f"Action server is not available after waiting {args.timeout} seconds.")
            finally:
                client.destroy()


def _send(spinning: _Spinning, client: Any, goal: Any, args: argparse.Namespace) -> None:
    """Send a goal and show what comes of it; Ctrl-C cancels it, and a second one ends.

    Raises:
        RuntimeError: if the server does not answer as it has to.
    """
    print(f"Sending goal:\n     {messages.to_yaml(goal)}")
    on_feedback = _show_feedback if args.feedback else None
    handle = spinning.result(client.send_goal_async(goal, on_feedback), "sending goal")
    if not handle.accepted:
        print("Goal was rejected.")
        return
    print(f"Goal accepted with ID: {bytes(handle.goal_id.uuid).hex()}\n")
    getting = handle.get_result_async()
    try:
        result = spinning.result(getting, "getting result", timeout=args.timeout)
    except TimeoutError:
        print(f"Timed out waiting for result after {args.timeout} seconds.")
        return
    except KeyboardInterrupt:
        _cancel(spinning, handle)
        result = spinning.result(getting, "getting result")
    print(f"Result:\n    {messages.to_yaml(result.result)}")
    print(f"Goal finished with status: {STATUSES[result.status]}")


def _cancel(spinning: _Spinning, handle: Any) -> None:
    print("Canceling goal...")
    canceling = spinning.result(handle.cancel_goal_async(), "canceling goal").goals_canceling
    if [canceled.goal_id for canceled in canceling] != [handle.goal_id]:
        raise RuntimeError("Failed to cancel goal")
    print("Goal canceled.")


class _Spinning:
    """Spins a node until something is there, or until Ctrl-C, after which it can go on.

    rclpy's own answer to Ctrl-C is the end of the context, in which nothing could be canceled any more.
    """

    def __init__(self, node: GraphNode) -> None:
        from rclpy.signals import uninstall_signal_handlers

        self._node = node.node
        self._is_interrupted = False
        uninstall_signal_handlers()
        signal.signal(signal.SIGINT, self._interrupt)

    def result(self, future: Any, what: str, timeout: float | None = None) -> Any:
        """Return what a future brings.

        Raises:
            KeyboardInterrupt: if Ctrl-C was pressed.
            TimeoutError: if it brings nothing in so many seconds.
            RuntimeError: if it brings an error.
        """
        import rclpy

        end = math.inf if timeout is None else time.monotonic() + timeout
        while not future.done():
            if time.monotonic() >= end:
                raise TimeoutError
            rclpy.spin_until_future_complete(self._node, future, timeout_sec=LOOK)
            if self._is_interrupted:
                self._is_interrupted = False
                raise KeyboardInterrupt
        if future.result() is None:
            raise RuntimeError(f"Exception while {what}: {future.exception()!r}")
        return future.result()

    def _interrupt(self, _: int, __: FrameType | None) -> None:
        self._is_interrupted = True


def _seconds(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError("value must not be a negative integer")
    return int(text)


def _show_feedback(message: Any) -> None:
    print(f"Feedback:\n    {messages.to_yaml(message.feedback)}")
