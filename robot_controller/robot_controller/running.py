"""Run a node as a process of its own, until Ctrl-C or SIGTERM.

rclpy's own answer to these signals makes the context invalid, and then nothing can be published
any more. A robot needs a last word, so here a signal only ends the spinning: the node is destroyed
while its context is still good, and the context goes last.
"""

import os
import signal
import sys
from collections.abc import Callable
from threading import Thread

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future


def run(make_node: Callable[[], Node], args: list[str] | None = None) -> None:
    """Make a node and spin it until Ctrl-C or SIGTERM; one that came during start-up counts too.

    Args:
        make_node: the node's class, or whatever makes it.
        args: the command line with its `--ros-args`; `sys.argv` if None.

    Raises:
        SystemExit: with a sentence, if the command line is wrong.
    """
    stop = _stop_signal()
    try:
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as error:
        sys.exit(f"ROS 2 does not start with this command line: {error}")
    try:
        node = make_node()
        try:
            rclpy.spin_until_future_complete(node, stop)
        finally:
            node.destroy_node()
    except ExternalShutdownException:
        pass
    finally:
        rclpy.try_shutdown()


def _stop_signal() -> Future:
    """Return a future that is done as soon as Ctrl-C or SIGTERM has come."""
    # Python runs its signal handlers between two of its own instructions, and so not while rclpy
    # waits. What it does at once is to write to the wake-up descriptor, whose other end a thread
    # reads.
    read_end, write_end = os.pipe()
    os.set_blocking(write_end, False)
    signal.set_wakeup_fd(write_end)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: None)
    stop = Future()
    Thread(
        target=lambda: stop.set_result(os.read(read_end, 1)),
        name="stop_signal",
        daemon=True,
    ).start()
    return stop
