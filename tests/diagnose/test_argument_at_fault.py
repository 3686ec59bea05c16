"""Which of several arguments is at fault: the one of whose types the error speaks, and what to give instead of it."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text
from ros2lab.diagnose.checking.type_words import not_taken
from ros2lab.diagnose.finding import Finding

NAME = NAMES[1]
NODE = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger


class Tracker:
    pass


def logged(request, response, tracker):
    return response


class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.tracker = Tracker()
        LINE

    def stop(self):
        print('stop')

    def receive(self, msg):
        print(msg.data)

    def receive_for(self, msg, tracker):
        print(msg.data, tracker)


def main():
    rclpy.init()
    rclpy.spin(Driver())
"""
QOS = "TypeError: Expected QoSProfile or int, but received <class '{}'>"
GROUP = "AttributeError: '{}' object has no attribute 'add_entity'"
OF_SERVICE = "AttributeError: '{}' object has no attribute 'get_c_qos_profile'"


def first(line: str, error: str, root: Path) -> Finding:
    files = Files.right(NAME)
    files.texts[files.path("driver")] = NODE.replace("LINE", line)
    files.write(root)
    number, path = NODE[: NODE.index("LINE")].count("\n") + 1, root / files.path("driver")
    report = (
        f'Traceback (most recent call last):\n  File "{path}", line {number}, in __init__\n    {line.splitlines()[0]}\n'
        f'  File "/opt/ros/jazzy/lib/python3.12/site-packages/rclpy/node.py", line 1462, in create\n    raise it\n{error}\n'
    )
    return of_text(report, root)[0]


@pytest.mark.parametrize(
    ("line", "error", "cause", "fix"),
    [
        ("self.create_subscription(String, 'x', self.receive_for, self.tracker)", QOS.format("a.Tracker"), "`self.tracker` is a Tracker", "`self.create_subscription(String, 'x', lambda msg: self.receive_for(msg, self.tracker), 10)`"),
        ("self.create_subscription(String, 'x', self.receive_for, (self.tracker,))", QOS.format("tuple"), "is a tuple", "lambda msg: self.receive_for(msg, self.tracker), 10)`"),
        ("self.create_subscription(\n            String, 'x', self.receive_for,\n            qos_profile=self.tracker)", QOS.format("a.Tracker"), "is a Tracker", "lambda msg: self.receive_for(msg, self.tracker), qos_profile=10)`"),
        ("self.create_subscription(String, 'x', self.receive_for, None)", QOS.format("NoneType"), "is given None", "`self.create_subscription(String, 'x', self.receive_for, 10)`"),
        ("self.create_subscription(String, 'x', self.receive, self.tracker)", QOS.format("a.Tracker"), "takes a QoSProfile or an integer", "`self.create_subscription(String, 'x', self.receive, 10)`"),
        ("self.out = self.create_publisher(String, 'x', self.tracker)", QOS.format("a.Tracker"), "`self.tracker` is a Tracker", "`self.create_publisher(String, 'x', 10)`"),
        ("self.create_service(Trigger, 'x', logged, qos_profile=self.tracker)", OF_SERVICE.format("Tracker"), "`qos_profile=self.tracker` is a Tracker", "`self.create_service(Trigger, 'x', lambda request, response: logged(request, response, self.tracker))`"),
        ("self.create_timer(1.0, self.receive, 'red')", GROUP.format("str"), "`'red'` is a string", "write `self.create_timer(1.0, functools.partial(self.receive, 'red'))`, with `import functools` at the top"),
        ("self.create_timer(1.0, self.receive_for, ('red', 2))", GROUP.format("tuple"), "", "`self.create_timer(1.0, functools.partial(self.receive_for, 'red', 2))`"),
        ("self.create_timer(1.0, self.receive, callback_group='red')", GROUP.format("str"), "", "`self.create_timer(1.0, functools.partial(self.receive, 'red'))`"),
        ("self.create_timer(1.0, self.stop, 'red')", GROUP.format("str"), "", "`self.create_timer(1.0, self.stop)`"),
        ("self.create_timer(self.receive, 1.0)", "TypeError: float() argument must be a string or a real number, not 'method'", "", "`self.create_timer(1.0, self.receive)`"),
    ],
)  # fmt: skip
def test_the_argument_of_which_the_error_speaks(
    tmp_path: Path, line: str, error: str, cause: str, fix: str
) -> None:
    found = first(line, error, tmp_path)
    assert cause in found.cause
    assert fix in found.fix


@pytest.mark.parametrize(
    ("wanted", "given", "words"),
    [
        ("(Unknown, /) -> None", "def receive(msg, tracker) -> Unknown", "calls `f` with 1 value, but it takes 2"),
        ("(Unknown, Unknown, /) -> None", "bound method A.f(self) -> None", "with 2 values, but it takes 0"),
        ("list[list[int]]", "list[list[str]]", "takes `list[list[int]]` here, but is given `list[list[str]]`"),
        ("float", "bool", "takes a float here, but `f` is True or False"),
    ],
)  # fmt: skip
def test_never_are_the_two_told_in_the_same_words(wanted: str, given: str, words: str) -> None:
    assert words in not_taken("create", "f", wanted, given)[0]
