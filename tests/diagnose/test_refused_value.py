"""Values that a field of a message refuses: which one, from where, and what takes it."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text, of_workspace
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.parameter_values import value_fix

NAME = NAMES[1]
INNER = f"src/{NAME.package}/{NAME.package}"
NODE = """\
import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node
from std_msgs.msg import Int8, UInt8

TABLE = {'stop': (0, 0)}


class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.declare_parameter('speed', 1)
        self.declare_parameter('turn', 0.3)
        self.out = self.create_publisher(Twist, 'cmd_vel', 10)
        self.count = self.create_publisher(UInt8, 'count', 10)
        self.number = 0

    def tick(self):
        speed = self.get_parameter('speed').value
        turn = self.get_parameter('turn').value
        x, z = TABLE['stop']
        msg = Twist()
        LINE
        self.out.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Driver())
"""


def first(line: str, message: str, root: Path, part: str = "") -> Finding:
    files = Files.right(NAME)
    files.texts[files.path("driver")] = NODE.replace("LINE", line)
    files.write(root)
    number = NODE[: NODE.index("LINE")].count("\n") + 1
    mark = f"    {' ' * line.index(part)}{'^' * len(part)}\n" if part else ""
    report = f'Traceback (most recent call last):\n  File "{root}/{INNER}/{NAME.driver}.py", line {number}, in tick\n    {line}\n{mark}AssertionError: {message}\n'
    return of_text(report, root)[0]


FLOAT = "The 'x' field must be of type 'float'"
BYTE = "The 'data' field must be an unsigned integer in [0, 255]"


@pytest.mark.parametrize(
    ("line", "message", "part", "fix"),
    [
        ("msg.linear.x = speed", FLOAT, "", "write 1.0 instead of 1"),
        ("msg.linear.x, msg.angular.z = x, z", FLOAT, "", "write `TABLE = {'stop': (0.0, 0)}`"),
        (
            "msg = Twist(linear=Vector3(x=speed), angular=Vector3(z=turn))",
            FLOAT,
            "Vector3(x=speed)",
            "write 1.0 instead of 1",
        ),
        (
            "msg.linear = Vector3(x=self.number)",
            FLOAT,
            "",
            "write `self.number = 0.0`",
        ),
        (
            "self.count.publish(UInt8(data=self.number))",
            BYTE,
            "UInt8(data=self.number)",
            "write Int16 instead of UInt8 everywhere, including where it is received; or keep it in that range, for example with min(max(self.number, 0), 255)",
        ),
        (
            "self.count.publish(Int8(data=self.number))",
            "The 'data' field must be an integer in [-128, 127]",
            "",
            "write Int16 instead of Int8 everywhere, including where it is received; or keep it in that range, for example with min(max(self.number, -128), 127)",
        ),
    ],
)
def test_the_value_in_the_line_is_named(tmp_path: Path, line: str, message: str, part: str, fix: str) -> None:
    assert first(line, message, tmp_path, part).fix == fix


@pytest.mark.parametrize(
    ("step", "kind", "says"),
    [
        ("self.number -= 1", "UInt8", "write Int16 instead of UInt8"),
        ("self.number += 5", "UInt8", "write UInt16 instead of UInt8"),
        ("self.number -= 1", "Int8", "write Int16 instead of Int8"),
        ("self.number -= self.step", "UInt8", "min(max(self.number, 0), 255)"),
        ("self.number += 1; self.number -= 2", "UInt8", "min(max(self.number, 0), 255)"),
    ],
)
def test_the_side_on_which_a_value_leaves_its_range(tmp_path: Path, step: str, kind: str, says: str) -> None:
    message = BYTE if kind == "UInt8" else "The 'data' field must be an integer in [-128, 127]"
    found = first(f"self.count.publish({kind}(data=self.number)); {step}", message, tmp_path)
    assert says in found.fix
    assert ("line 23 counts it" in found.cause) is ("min(" not in found.fix)


@pytest.mark.parametrize(
    ("value", "kind", "wanted", "says"),
    [
        ("['a', 'b']", "STRING_ARRAY", "BYTE_ARRAY", "Parameter.Type.STRING_ARRAY"),
        ("[1, -2]", "INTEGER_ARRAY", "DOUBLE_ARRAY", "doors: [1.0, -2.0]"),
        ("2", "INTEGER", "INTEGER_ARRAY", "write a list: doors: [2]"),
        ("2", "INTEGER", "DOUBLE", "doors: 2.0"),
    ],
)
def test_a_parameter_of_another_type(value: str, kind: str, wanted: str, says: str) -> None:
    assert says in value_fix("doors", value, kind, wanted)


@pytest.mark.parametrize("line", ["yield msg", "yield from [msg]"])
def test_a_callback_that_yields_never_runs(tmp_path: Path, line: str) -> None:
    files = Files.right(NAME).change(
        "node", "        msg = String()\n", f"        msg = String()\n        {line}\n"
    )
    found = [one for one in of_workspace(files.write(tmp_path)) if one.code == "never-called"]
    assert len(found) == 1
    assert f"makes {NAME.callback}() a generator" in found[0].cause


@pytest.mark.parametrize(
    "payload",
    [
        "data: 'error: 0 failed'",
        "level: 2\nmsg: unknown command\nname: driver",
        "position:\n  x: .nan\nfrom: error",
    ],
)
def test_what_messages_say_is_no_error(tmp_path: Path, payload: str) -> None:
    text = f"$ ros2 topic echo --once /report\n{payload}\n---\n"
    assert of_text(text, Files.right(NAME).write(tmp_path)) == []
