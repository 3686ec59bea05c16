"""Programs that end at once, in every way that a program can end, and two that wait."""

from __future__ import annotations

import os
import signal
import sys
import time


def say() -> None:
    """Print the arguments."""
    print("say", *sys.argv[1:], flush=True)


def fail() -> int:
    """End with 3."""
    print("failing", file=sys.stderr, flush=True)
    return 3


def dies() -> None:
    """End by a signal."""
    os.kill(os.getpid(), signal.SIGKILL)


def waits() -> int:
    """Wait for Ctrl-C, and end with 0."""
    print("waiting", flush=True)
    try:
        time.sleep(60)
    except KeyboardInterrupt:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # launch hands on what the terminal has sent already
        print("interrupted", flush=True)
    return 0


def stubborn() -> None:
    """Wait, whatever the signals."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    print("waiting", flush=True)
    for _ in range(30):
        time.sleep(1)


def terminal() -> None:
    """Return whether there is a terminal."""
    print(f"stdout {sys.stdout.isatty()}, stderr {sys.stderr.isatty()}", flush=True)


def shows() -> None:
    """Print the name of a node, its parameters and what its topic is called."""
    import rclpy  # noqa: PLC0415 -- the others start without it
    from rclpy.node import Node  # noqa: PLC0415

    rclpy.init()
    node = Node("shows", automatically_declare_parameters_from_overrides=True)
    print(f"node {node.get_fully_qualified_name()}, topic {node.resolve_topic_name('chatter')}")
    for name, parameter in sorted(node.get_parameters_by_prefix("").items()):
        print(f"parameter {name} {parameter.type_.name} {parameter.value!r}")
    free = rclpy.utilities.remove_ros_args(sys.argv)[1:]
    print(f"arguments {free}, COLOUR {os.environ.get('COLOUR')}", flush=True)
    node.destroy_node()
    rclpy.try_shutdown()
