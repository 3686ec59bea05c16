"""What the three commands of this package call.

Most of a node's start-up is the import of ROS, and a Ctrl-C then would end in a traceback.
So a command first sees to the signals, and only then imports its node.
"""

import os
import signal
from importlib import import_module


def status_publisher() -> None:
    """Run the node that tells how the robot is."""
    _start("status_publisher")


def command_subscriber() -> None:
    """Run the node that obeys the commands."""
    _start("command_subscriber")


def velocity_publisher() -> None:
    """Run the node that drives the robot."""
    _start("velocity_publisher")


def _start(module: str) -> None:
    for number in (signal.SIGINT, signal.SIGTERM):
        # Nothing has begun, so nothing has to be ended.
        signal.signal(number, lambda *_: os._exit(0))
    import_module(f"robot_controller.{module}").main()
