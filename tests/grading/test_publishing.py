"""What code does with the ends that it makes, as far as its names tell."""

from __future__ import annotations

import pytest

from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.grading.evidence import WrittenEnd
from ros2lab.grading.reading.written_ends import written_ends

SOURCE = """
from enum import Enum
import math
import threading
import time
import board
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Bool, Float64, String
from std_srvs.srv import SetBool


class Mode(Enum):
    IDLE = 0
    READY = 1


class Status(Node):
    def __init__(self):
        super().__init__("status")
        self.state = START
        self.count = 0
        self.board = board.Board(17)
        self.out = self.create_publisher(String, "/robot/status", 10)
        self.create_subscription(KIND, "/permission", self.permit, 10)
        self.timer = self.create_timer(2.0, self.tick)

    def permit(self, message):
        PERMIT

    def tick(self):
        GATE
        self.out.publish(String(data="well"))


def main():
    rclpy.init()
    node = Status()
    rclpy.spin(node)
    END
"""


def _status(text: str) -> WrittenEnd:
    source = PythonSource("status", "status.py", text)
    assert source.tree.body, source.fault
    return next(end for end in written_ends([source])[0] if end.topic == "/robot/status")


def _filled(gate: str, permit: str = "pass", start: str = "None", kind: str = "Bool", end: str = "") -> str:
    filled = SOURCE.replace("START", start).replace("KIND", kind).replace("PERMIT", permit)
    return filled.replace("GATE", gate).replace("END", end)


def test_what_comes_behind_a_spin_is_no_work() -> None:
    """The program has had its life; what it says last is right beside what it has said before."""
    last = "node.out.publish(String())"
    assert _status(_filled("pass", end=last)).does == ["publishes"]
    assert _status(_filled("return", end=last)).does == []
    shut = _filled("return").replace("rclpy.spin(node)", f"rclpy.shutdown()\n    while True: {last}")
    assert _status(shut).does == []


@pytest.mark.parametrize(
    ("right", "other", "does"),
    [
        ('String(data="well")', "self.text()", ["publishes"]),
        ('String(data="well")', "board.text()", ["publishes"]),
        ("self.out = self", "out = self", []),
        ("self.out.publish", "print(self.out is None, self.timer.publish), self.count.publish", []),
        ("self.out.publish", "self.again = self.out; self.again.publish", ["publishes"]),
        ("self.out.publish", "self.again = self.out; print", []),
    ],
)
def test_what_is_published_and_on_what(right: str, other: str, does: list[str]) -> None:
    text = _filled("pass").replace(right, other, 1)
    text = text.replace("    def tick", "    def text(self): return self.made\n    def tick")
    text = text.replace('super().__init__("status")', 'super().__init__("status"); self.made = board.text()')
    assert _status(text).does == does


@pytest.mark.parametrize(
    ("timer", "never"),
    [
        ("self.create_timer(2.0, self.tick)", []),
        ("self.create_timer(timer_period_sec=7.0, callback=self.tick)", []),
        ("self.create_timer(7.0, lambda: self.tick())", []),
        ("self.create_timer(self.declare_parameter('period', 3.0).value * 2, self.tick)", []),
        ("self.create_timer(board.period(), self.tick)", []),
        ("board.every(2.0, self.tick)", []),
        ("self.tick()", ["repeats"]),
        ("threading.Thread(target=self.tick).start()", ["repeats"]),
        ("threading.Thread(target=self.loop).start()", []),
        ("board.ask().add_done_callback(self.tick)", ["repeats"]),
        ("[self.tick() for _ in range(9)]", []),
    ],
)
def test_how_often_something_comes(timer: str, never: list[str]) -> None:
    text = _filled("pass").replace("self.create_timer(2.0, self.tick)", timer)
    text = text.replace(
        "def tick(self)", "def loop(self):\n        while rclpy.ok(): self.tick()\n\n    def tick(self)"
    )
    told = _status(text)
    assert (told.does, told.never) == (["publishes"], [*never, "varies"])


@pytest.mark.parametrize(
    ("value", "never"),
    [
        ("0.5", ["varies"]),
        ("-0.5; twist.angular.z = 1.0", ["varies"]),
        ("0.5; self.twist = twist", []),
        ("0.5\n        if self.count: twist.linear.x = 0.1", []),
        ("0.5; twist = self.count or twist", []),
        ("0.5; self.out.publish(Twist())", []),
        ("board.speed()", []),
        ("float('nan') if self.count else 0.5", []),
    ],
)
def test_what_a_message_holds(value: str, never: list[str]) -> None:
    text = _filled(f"twist = Twist(); twist.linear.x = {value}").replace(
        "create_publisher(String", "create_publisher(Twist"
    )
    assert _status(text.replace('String(data="well")', "twist")).never == never


PLAIN = """
import rclpy
from std_msgs.msg import String


def hear(message):
    print(message.data)


def main():
    rclpy.init()
    node = rclpy.create_node("commands")
    taken = node.create_subscription(String, "/robot/command", hear, 10)
    THEN
    node.destroy_subscription(taken)
    node.destroy_node()
"""


@pytest.mark.parametrize(
    ("then", "does"),
    [
        ("pass", []),
        ("rclpy.spin(node)", ["reads", "logs"]),
        ("rclpy.spin_once(node)", ["reads", "logs"]),
        ("while rclpy.ok(): rclpy.spin_once(node)", ["reads", "logs"]),
        ("print('ready')", []),
        ("taken.topic", []),
    ],
)
def test_an_end_that_is_destroyed_at_once_is_not_used(then: str, does: list[str]) -> None:
    told = written_ends(
        [PythonSource("commands", "commands.py", PLAIN.replace("THEN", then))], words=("start",)
    )[0]
    assert [end.does for end in told] == [does]


@pytest.mark.parametrize(
    ("reads", "does"),
    [
        ("message.data", ["reads", "logs"]),
        ("message", ["reads", "logs"]),
        ("message.get_fields_and_field_types()", ["reads", "logs"]),
        ("message.text", ["logs"]),
    ],
)
def test_what_no_message_has_is_not_read(reads: str, does: list[str]) -> None:
    text = PLAIN.replace("message.data", reads).replace("THEN", "rclpy.spin(node)")
    assert [
        end.does for end in written_ends([PythonSource("commands", "commands.py", text)], words=("start",))[0]
    ] == [does]
