"""From a command in the kernel to the changed Twist at another process, against one bare hop."""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from contextlib import ExitStack

from kernel import THREE_NODES, Kernel
from place import own_place
from program import Program
from row import Quantity, Row

WARM_UP = 6  # even: the first command is `start`


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Send commands from a kernel and Twists from a bare process by turns, and time both."""
    count = 20 if is_quick else 400
    commands, hops = [], []
    with ExitStack() as stack:
        place = stack.enter_context(own_place())
        kernel = stack.enter_context(Kernel(place.environ, place.folder))
        robot = stack.enter_context(Program("listener.py", "/cmd_vel", "Twist", environ=place.environ))
        hop = stack.enter_context(Program("listener.py", "/hop", "Twist", environ=place.environ))
        sender = stack.enter_context(Program("sender.py", "/hop", environ=place.environ))
        kernel.run(f"import time\n{THREE_NODES}")
        robot.hear(lambda twist: twist["value"] == 0.0)
        _meet(sender, hop)
        for turn in range(-WARM_UP, count):
            # By turns, so that whatever else the machine does hits both; at any phase of the timers.
            _pause()
            command = _time_command(kernel, robot, turn % 2 == 0)
            _pause()
            bare = _time_hop(sender, hop, float(turn))
            if turn >= 0:
                commands.append(command)
                hops.append(bare)
                advance((turn + 1) / count)
    return [
        Row(
            "command in the kernel → changed Twist at another process",
            Quantity.of_samples(commands, "ms"),
            "one bare rclpy hop between two processes",
            Quantity.of_samples(hops, "ms"),
            {"ratio": 3.0},
            "three hops: /robot/command and /robot/state within the kernel, /cmd_vel to the other process",
        )
    ]


def _time_command(kernel: Kernel, robot: Program, is_start: bool) -> float:
    """Return the time in ms from a cell's command to the Twist that it brings about."""
    word, speed = ("start", 0.5) if is_start else ("stop", 0.0)
    kernel.run(f"sent = time.monotonic()\nsession.publish('/robot/command', {word!r})")
    twist = robot.hear(lambda twist: twist["value"] == speed)
    # Asked for afterwards: while the kernel answers, its nodes wait.
    seconds = twist["monotonic"] - kernel.run("", "sent")
    if seconds < 0:
        raise RuntimeError(
            "The Twist changed before the command: somebody else drives a robot in this domain; "
            "set ROS_DOMAIN_ID to another one."
        )
    return 1000 * seconds


def _time_hop(sender: Program, listener: Program, value: float) -> float:
    """Return the time in ms that a Twist takes from one process to another."""
    sender.tell(value)
    sent = sender.hear()
    twist = listener.hear(lambda twist: twist["value"] == value)
    return 1000 * (twist["monotonic"] - sent)


def _meet(sender: Program, listener: Program) -> None:
    """Send until it is heard: what is published before the two have found each other is lost."""
    for attempt in range(100):
        sender.tell(1000.0 + attempt)
        sender.hear()
        try:
            listener.hear(timeout=0.2)
        except TimeoutError:
            continue
        return
    raise TimeoutError("The bare sender and its listener did not find each other in 20 s.")


def _pause() -> None:
    time.sleep(random.uniform(0.02, 0.06))
