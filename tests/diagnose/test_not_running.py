"""A line that needs rclpy while it is not running: what has ended it, and what to change."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

NAME = NAMES[1]
INNER = f"src/{NAME.package}/{NAME.package}/{NAME.module}.py"
INVALID = "rclpy._rclpy_pybind11.RCLError: Failed to publish: publisher's context is invalid, at ./src/rcl/publisher.c:423"
NODE = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'said', 10)
        {making}

    def tick(self):
        self.publisher.publish(String(data='well'))


def main(args=None):
{main}
"""
SPIN = "rclpy.init(args=args)\nnode = Talker()\n"


def told(
    folder: Path,
    main: str,
    wrong: str,
    said: str = INVALID,
    making: str = "self.create_timer(1.0, self.tick)",
) -> tuple[str, str]:
    """Return cause and fix of a traceback at the line of main that contains a text."""
    text = NODE.format(making=making, main="\n".join(f"    {line}" for line in main.split("\n")))
    files = Files.right(NAME)
    files.texts[INNER] = text
    path = (root := files.write(folder)) / INNER
    line = text[: text.rindex(wrong)].count("\n") + 1
    printed = (
        f'Traceback (most recent call last):\n  File "{path}", line {line}, in main\n    {wrong}\n{said}\n'
    )
    first = of_text(printed, root)[0]
    return first.cause, first.fix


STOP = "node.publisher.publish(String(data='stopped'))"
AT_THE_END = f"{SPIN}try:\n    rclpy.spin(node)\nexcept KeyboardInterrupt:\n    {STOP}\nrclpy.try_shutdown()"


@pytest.mark.parametrize(
    "main",
    [
        AT_THE_END,
        f"{SPIN}try:\n    rclpy.spin(node)\nfinally:\n    {STOP}\n    rclpy.try_shutdown()",
        f"{SPIN}rclpy.spin(node)\n{STOP}\nrclpy.try_shutdown()",
    ],
)
def test_what_a_node_says_at_ctrl_c(tmp_path: Path, main: str) -> None:
    cause, fix = told(tmp_path, main, STOP)
    assert "Ctrl-C has already shut it down" in cause
    assert "`rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)` on line 17" in fix
    assert "timer" not in fix


def test_a_node_without_a_timer_does_not_notice_ctrl_c(tmp_path: Path) -> None:
    assert "give the node a timer" in told(tmp_path, AT_THE_END, STOP, making="pass")[1]


@pytest.mark.parametrize(
    ("loop", "better"),
    [("while True:", "while rclpy.ok():"), ("while node.count < 9:", "while rclpy.ok() and node.count < 9:")],
)
def test_a_loop_that_goes_on(tmp_path: Path, loop: str, better: str) -> None:
    cause, fix = told(tmp_path, f"{SPIN}{loop}\n    {STOP}", STOP)
    assert cause.endswith("but the loop goes on.")
    assert fix == f"write `{better}` on line 19"


def test_a_line_below_the_shutdown(tmp_path: Path) -> None:
    cause, fix = told(tmp_path, f"{SPIN}rclpy.spin(node)\nrclpy.shutdown()\n{STOP}", STOP)
    assert "line 20 has already shut it down" in cause
    assert fix == "move the line up, above line 20"


def test_a_line_above_the_initialization(tmp_path: Path) -> None:
    main = "executor = rclpy.executors.SingleThreadedExecutor()\nrclpy.init(args=args)\nexecutor.spin()"
    said = "rclpy.exceptions.NotInitializedException: ('rclpy.init() has not been called', 'cannot create an executor')"
    cause, fix = told(tmp_path, main, "executor = rclpy", said)
    assert "init" in cause
    assert "rclpy.init" in fix or "line 18" in fix


GONE = "rclpy._rclpy_pybind11.InvalidHandle: cannot use Destroyable because destruction was requested"
MORE = "self.create_timer(1.0, self.tick)\n\n    def heard(self, msg):\n        "
USED = "self.publisher.publish(String(data='well'))"


@pytest.mark.parametrize(
    ("more", "main", "wrong", "said"),
    [
        ("self.destroy_publisher(self.publisher)", SPIN, USED, ("uses self.publisher, which line 13 has", "write `self.publisher = None` below line 13, `if self.publisher is not None:` above line 16")),
        ("self.publisher.destroy()", SPIN, USED, ("uses self.publisher, which line 13 has", "write `self.publisher = None`")),
        ("super().destroy_node()", SPIN, USED, ("uses the node, which line 13 has", "remove line 13, and destroy")),
        ("self.destroy_timer(self.timer)\n\n    def again(self):\n        self.timer.reset()", SPIN, "self.timer.reset()", ("uses self.timer, which line 13 has", "write self.timer.cancel() instead of self.destroy_timer(self.timer)")),
        ("pass", f"{SPIN}node.destroy_node()\nnode.tick()", "node.tick()", ("uses the node, which line 22 has", "destroy it later: move line 22 below line 23")),
        ("pass", f"{SPIN}rclpy.spin(node)\nnode.destroy_node()", USED, ("uses something that", "use it only before")),
        ("pass\n\n\nclass B(Node):\n    def stop(self):\n        self.destroy_publisher(self.publisher)", SPIN, "self.publisher = ", ("uses something that", "use it only before")),
        ("self.destroy_publisher(self.publisher)\n        self.publisher.destroy()", SPIN, USED, ("uses something that", "use it only before")),
    ],
)  # fmt: skip
def test_what_was_destroyed_and_where(
    tmp_path: Path, more: str, main: str, wrong: str, said: tuple[str, str]
) -> None:
    cause, fix = told(tmp_path, main.strip(), wrong, GONE, MORE + more)
    assert said[0] in cause
    assert fix.startswith(said[1])
