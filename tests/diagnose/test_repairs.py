"""Of a line at which Python stops, a change is told that was tried: it is what a student is to write, word by word."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text, of_workspace
from ros2lab.diagnose.checking.edits import Edit
from ros2lab.diagnose.checking.trials import Trial
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.python_source import PythonSource

NAME = NAMES[1]
LISTENER = """import datetime
import math
import os
import random
import threading
import time
import uuid
from enum import Enum

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import String


class Level(Enum):
    LOW = 0
    HIGH = 1


class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        self.speeds = {'slow': 0.1, 'fast': 1.0}
        self.words = {'start', 'stop'}
        self.names = ['b', 'a']
        self.buffer = b''
        self.count = 0
        self.charge = 100
        self.begun = self.get_clock().now
        self.subscription = self.create_subscription(String, '/robot/command', self.on_command, 10)
        self.out = self.create_publisher(String, '/robot/answer', 10)
        self.timer = self.create_timer(1.0, self.work)

    def work(self):
        self.count += 1

    def obey(self, msg):
        self.get_logger().info(msg.data)

    def on_command(self, msg):
        LINES


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Listener())
"""
# What stands in the callback, the line that fails first unless it is the last, what Python says, and what to write.
FAILS: dict[str, tuple[str, str, str]] = {
    "a number is gone through": ("for i in 5:\n            self.work()", "TypeError: 'int' object is not iterable", "for i in range(5):"),
    "a function where one is called later": ("threading.Thread(self.work).start()", "AssertionError: group argument must be None for now", "threading.Thread(target=self.work).start()"),
    "a key as an attribute": ("self.speed = self.speeds.slow", "AttributeError: 'dict' object has no attribute 'slow'", "self.speed = self.speeds['slow']"),
    "a method of another object, with what that knows": ("self.publish('/robot/answer', msg)", "AttributeError: 'Listener' object has no attribute 'publish'", "self.out.publish(msg)"),
    "a message for its text": ("word = msg.strip()", "AttributeError: 'String' object has no attribute 'strip'", "word = msg.data.strip()"),
    "a text for a number": ("d = math.sqrt(msg.data)", "TypeError: must be real number, not str", "d = math.sqrt(float(msg.data))"),
    "texts are summed": ("total = sum(msg.data.split(','))", "TypeError: unsupported operand type(s) for +: 'int' and 'str'", "total = sum(map(float, msg.data.split(',')))"),
    "numbers are joined": ("self.get_logger().info(', '.join([1, 2]))", "TypeError: sequence item 0: expected str instance, int found", "self.get_logger().info(', '.join(['1', '2']))"),
    "a set has no first": ("word = random.choice(self.words)", "TypeError: 'set' object is not subscriptable", "word = random.choice(list(self.words))"),
    "half an index": ("name = self.names[len(self.names) / 2]", "TypeError: list indices must be integers or slices, not float", "name = self.names[len(self.names) // 2]"),
    "a number in quotes": ("self.speed = round(0.333, '2')", "TypeError: 'str' object cannot be interpreted as an integer", "self.speed = round(0.333, 2)"),
    "what may be missing": ("name = os.getenv('ROBOT').upper()", "AttributeError: 'NoneType' object has no attribute 'upper'", "name = (os.getenv('ROBOT') or '').upper()"),
    "a constant that is called": ("angle = 2 * math.pi()", "TypeError: 'float' object is not callable", "angle = 2 * math.pi"),
    "a value of an enum": ("level = Level.HIGH + 1", "TypeError: unsupported operand type(s) for +: 'Level' and 'int'", "level = Level.HIGH.value + 1"),
    "an object for its text": ("self.get_logger().info('id ' + uuid.uuid4())", 'TypeError: can only concatenate str (not "UUID") to str', "self.get_logger().info('id ' + str(uuid.uuid4()))"),
    "a method for its text": ("self.get_logger().info('I am ' + self.get_name)", 'TypeError: can only concatenate str (not "method") to str', "self.get_logger().info('I am ' + self.get_name())"),
    "a point in time among seconds": ("age = time.time() - self.get_clock().now()", "TypeError: unsupported operand type(s) for -: 'float' and 'Time'", "age = time.time() - self.get_clock().now().nanoseconds / 1e9"),
    "an attribute that has another name where it is set": ("level = self.share", "AttributeError: 'Listener' object has no attribute 'share'", "level = self.charge"),
    "a comma for a dot": ("self.out,publish(msg)", "NameError: name 'publish' is not defined", "self.out.publish(msg)"),
    "a comma for a dot in a call": ("self.out.publish(String(data=str(msg,data)))", "NameError: name 'data' is not defined", "self.out.publish(String(data=str(msg.data)))"),
    "a method under half its name": ("self.logger.info('hello')", "AttributeError: 'Listener' object has no attribute 'logger'", "self.get_logger().info('hello')"),
}  # fmt: skip
# What is changed is changed in another one of these in the same way.
OF_A_KIND = {
    "a text for a number",
    "numbers are joined",
    "a set has no first",
    "a method for its text",
    "a comma for a dot in a call",
    "an object for its text",
    "a time that was never asked for",
}
# The same, where another line is the one to mend: that line's end, and what to write there.
ELSEWHERE: dict[str, tuple[str, str, str, str]] = {
    "a time that was never asked for": ("age = self.get_clock().now() - self.begun", "TypeError: unsupported operand type(s) for -: 'Time' and 'method'", "self.get_clock().now", "self.begun = self.get_clock().now()"),
    "a class for its object": ("out = Twist\n        out.linear.x = 0.5", "AttributeError: 'property' object has no attribute 'x'", "out = Twist", "out = Twist()"),
    "bytes for a text": ("self.buffer += msg.data", "TypeError: can't concat str to bytes", "b''", "self.buffer = ''"),
}  # fmt: skip


def first(lines: str, said: str, folder: Path) -> tuple[Finding, str]:
    """Return what is told of a callback that fails, and the line at which."""
    text = LISTENER.replace("LINES", lines)
    root = Files.right(NAME).put(f"{NAME.package}/{NAME.listener}.py", text).write(folder)
    failing = lines if lines.startswith("for") else lines.splitlines()[-1]
    line = text[: text.index(failing)].count("\n") + 1
    path = root / "src" / NAME.package / NAME.package / f"{NAME.listener}.py"
    printed = (
        f'Traceback (most recent call last):\n  File "{path}", line {line}, in on_command\n'
        f"    {failing.splitlines()[0].strip()}\n{said}\n"
    )
    return of_text(printed, root)[0], f"src/{NAME.package}/{NAME.package}/{NAME.listener}.py:{line}"


def cases(rows: Iterable[str]) -> Any:
    return pytest.mark.parametrize(
        "case", [pytest.param(row, marks=pytest.mark.thorough if row in OF_A_KIND else ()) for row in rows]
    )


@cases(FAILS)
def test_a_change_of_the_line(case: str, tmp_path: Path) -> None:
    lines, said, wanted = FAILS[case]
    told, place = first(lines, said, tmp_path)
    assert (told.place, told.fix) == (place, f"write `{wanted}`")


@cases(ELSEWHERE)
def test_a_change_of_the_line_that_made_the_value(case: str, tmp_path: Path) -> None:
    lines, said, ends, wanted = ELSEWHERE[case]
    told, place = first(lines, said, tmp_path)
    number = (
        LISTENER.replace("LINES", lines)
        .splitlines()
        .index(next(one for one in LISTENER.replace("LINES", lines).splitlines() if one.endswith(ends)))
    )
    assert told.place == f"{place.rpartition(':')[0]}:{number + 1}"
    assert told.fix == f"write `{wanted}`"
    assert told.cause.endswith(f"Line {place.rpartition(':')[2]} fails because of this one.")


def test_what_nothing_tells_apart_is_told_as_such(tmp_path: Path) -> None:
    said = "TypeError: Listener.obey() takes 2 positional arguments but 3 were given"
    told, _ = first("self.obey('a', msg)", said, tmp_path)
    assert told.fix == "write `self.obey(msg)`, or `self.obey('a')`"


def test_a_call_that_gives_nothing(tmp_path: Path) -> None:
    lines = "names = sorted(self.names).append('c')\n        self.get_logger().info(', '.join(names))"
    told, place = first(lines, "TypeError: can only join an iterable", tmp_path)
    assert told.place == f"{place.rpartition(':')[0]}:{int(place.rpartition(':')[2]) - 1}"
    assert told.fix == "write names = sorted(self.names), and names.append('c') on a line of its own below it"


@pytest.mark.parametrize(
    ("line", "said"),
    [
        # Any of three methods could be meant, and the type checker knows nothing of what these give.
        ("self.timer.stop()", "AttributeError: 'Timer' object has no attribute 'stop'"),
        # It has no objection here.
        ("speed = self.speeds[msg.data]", "KeyError: 'medium'"),
    ],
)
def test_what_cannot_be_told_is_not(line: str, said: str, tmp_path: Path) -> None:
    told, _ = first(line, said, tmp_path)
    assert not told.fix.startswith(f"write `{line.partition('(')[0]}")


LAUNCH = """from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, LogInfo, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def make(context):
    return [Node(package='my_bot', executable='talker')]


def generate_launch_description():
    name = LaunchConfiguration('name')
    left = Node(package='my_bot', executable='talker')
    right = Node(package='my_bot', executable='ears')
    LINE
"""


@pytest.mark.parametrize(
    ("line", "said", "wanted"),
    [
        (
            "return LaunchDescription(left, right)",
            "TypeError: LaunchDescription.__init__() takes from 1 to 2 positional arguments but 3 were given",
            "return LaunchDescription([left, right])",
        ),
        (
            "return LaunchDescription([DeclareLaunchArgument('name'), Node(package='my_bot', executable='ears', name=name + '_1')])",
            "TypeError: unsupported operand type(s) for +: 'LaunchConfiguration' and 'str'",
            "[name, '_1'] instead of name + '_1'",
        ),
        (
            "return LaunchDescription([left, right, Node(package='my_bot', executable=wheels)])",
            "NameError: name 'wheels' is not defined",
            "return LaunchDescription([left, right, Node(package='my_bot', executable='wheels')])",
        ),
        (
            "return [left, right]",
            "InvalidPythonLaunchFileError: generate_launch_description() in the launch file at 'x' must return a "
            "LaunchDescription, but it returns [<launch_ros.actions.node.Node object at 0x7f>]",
            "return LaunchDescription([left, right])",
        ),
        (
            "return LaunchDescription([left, ExecuteProcess('ros2 topic list')])",
            "TypeError: ExecuteProcess.__init__() takes 1 positional argument but 2 were given",
            "return LaunchDescription([left, ExecuteProcess(cmd=['ros2', 'topic', 'list'])])",
        ),
        (
            "return LaunchDescription([OpaqueFunction(function=make(None))])",
            "TypeError: OpaqueFunction expected a callable for 'function', got '<class 'list'>'",
            "return LaunchDescription([OpaqueFunction(function=make)])",
        ),
        (
            "return LaunchDescription([Node(package='my_bot', executable='ears', arguments=['--rate', 5])])",
            "TypeError: 'int' object is not iterable",
            "return LaunchDescription([Node(package='my_bot', executable='ears', arguments=['--rate', '5'])])",
        ),
        pytest.param(
            "return LaunchDescription([Node(package='my_bot', executable='ears', condition=IfCondition(True))])",
            "TypeError: 'bool' object is not iterable",
            "IfCondition('True')",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            "return LaunchDescription([LogInfo(msg=5), left])",
            "TypeError: 'int' object is not iterable",
            "return LaunchDescription([LogInfo(msg='5'), left])",
            marks=pytest.mark.thorough,
        ),
    ],
)
def test_a_change_of_a_launch_file_keeps_all_that_it_starts(
    line: str, said: str, wanted: str, tmp_path: Path
) -> None:
    root = Files.right(NAME).put("launch/robot.launch.py", LAUNCH.replace("LINE", line)).write(tmp_path)
    printed = (
        "student$ ros2 launch my_bot robot.launch.py\n[ERROR] [launch]: Caught exception in launch (see debug for "
        f"traceback): Caught multiple exceptions when trying to load file of format [py]:\n - {said}\n"
    )
    told, _, otherwise = of_text(printed, root)[0].fix.partition(" if it is meant as a string; ")
    assert told.replace("`", "") == f"write {wanted}"
    assert not otherwise or "NameError" in said


LIST = """    return LaunchDescription([
        DeclareLaunchArgument('on', default_value='true'),
        ACTION,
    ])
"""


@pytest.mark.parametrize(
    ("action", "said", "wanted"),
    [
        (
            "Node(package='my_bot', executable='talker', condition=LaunchConfiguration('on'))",
            "'LaunchConfiguration' object has no attribute 'evaluate'",
            "IfCondition(LaunchConfiguration('on')) instead of LaunchConfiguration('on')",
        ),
        (
            "OpaqueFunction(function=start)",
            "start() takes 0 positional arguments but 1 was given",
            "`def start(context):`",
        ),
    ],
)
def test_a_change_where_launch_names_no_line(action: str, said: str, wanted: str, tmp_path: Path) -> None:
    text = LAUNCH.replace("    LINE\n", LIST.replace("ACTION", action))
    text += "\n\ndef start():\n    return [Node(package='my_bot', executable='ears')]\n"
    root = Files.right(NAME).put("launch/robot.launch.py", text).write(tmp_path)
    printed = f"[ERROR] [launch]: Caught exception in launch (see debug for traceback): {said}\n"
    assert (
        of_text(f"student$ ros2 launch my_bot robot.launch.py\n{printed}", root)[0].fix == f"write {wanted}"
    )


@pytest.mark.parametrize(
    ("actions", "place", "fix"),
    [
        (
            "Node(package='my_bot', executable='talker', name=LaunchConfiguration('as'))\n"
            "        DeclareLaunchArgument('as', default_value='me')",
            19,
            "move DeclareLaunchArgument('as', ...) above",
        ),
        (
            "Node(package='my_bot', executable='talker', condition=IfCondition(LaunchConfiguration('as') == 'me'))",
            18,
            "write EqualsSubstitution(LaunchConfiguration('as'), 'me') here",
        ),
    ],
)
def test_a_value_that_is_asked_for_too_early(actions: str, place: int, fix: str, tmp_path: Path) -> None:
    text = LAUNCH.replace("    LINE\n", LIST.replace("ACTION", actions.replace(")\n", "),\n")))
    root = Files.right(NAME).put("launch/robot.launch.py", text).write(tmp_path)
    told = next(one for one in of_workspace(root) if one.code == "launch-argument")
    assert told.place.endswith(f".launch.py:{place}")
    assert told.fix.startswith(fix)


def test_a_call_that_lacks_what_is_there_is_still_made(tmp_path: Path) -> None:
    files = Files.right(NAME).change("driver", "rclpy.spin(node)", "rclpy.spin()")
    root = files.write(tmp_path)
    path = root / "src" / NAME.package / NAME.package / f"{NAME.driver}.py"
    line = path.read_text().splitlines().index("    rclpy.spin()") + 1
    printed = (
        f'Traceback (most recent call last):\n  File "{path}", line {line}, in main\n    rclpy.spin()\n'
        "TypeError: spin() missing 1 required positional argument: 'node'\n"
    )
    assert of_text(printed, root)[0].fix == "write `rclpy.spin(node)`"


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ("log.infos('a')  # to be seen\n", "`log.info('a')`"),
        ("log.infos(\n    'a')\n", "`log.info('a')`"),
        ("log.infos(  # to be seen\n    'a',\n    'b')\n", "`log.info('a', 'b')`"),
        ("if log.infos(\n        'a'):\n    pass\n", "`if log.info('a'):`"),
        (f"log.infos(\n    '{'a' * 110}')\n", "`log.info` instead of `log.infos`"),
    ],
)
def test_a_fix_is_never_a_part_of_a_statement_over_several_lines(
    written: str, told: str, tmp_path: Path
) -> None:
    source = PythonSource("talk", "talk.py", written)
    trial = Trial(source, Spot(source, 1), Look(Files.right(NAME).write(tmp_path)))
    (wrong,) = (node for node in source.nodes if isinstance(node, ast.Attribute))
    assert trial.told(Edit(wrong, "log.info")) == told
