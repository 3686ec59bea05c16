"""Fields that hold lists, given something else: real messages refuse it, and take what is told in its place."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from one_file import printed_by
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

NAME = NAMES[1]
ARM = """\
import numpy
from geometry_msgs.msg import Point, PoseWithCovariance
from sensor_msgs.msg import Imu, JointState, LaserScan
from std_msgs.msg import Float32MultiArray, Int32MultiArray, UInt8MultiArray
from visualization_msgs.msg import Marker


class Arm:
    NOISE = [0.1, 0.2, 0.3, 0.0, 0.0, 0.1]

    def __init__(self):
        self.joint = 'elbow'
        self.angles = {'elbow': 0.5}
        self.steps = [1, 2]

    def move(self):
        LINES


Arm().move()
"""
# What is written, and what is to be written in its place.
WRONG = {
    "a text": ("msg = JointState()\n        msg.name = 'elbow'", "msg.name = ['elbow']"),
    "a text in parentheses": ("msg = JointState()\n        msg.name = ('elbow')", "msg.name = ['elbow']"),
    "a text of the object": ("msg = JointState()\n        msg.name = self.joint", "msg.name = [self.joint]"),
    "a text with a value in it": ("n = 1\n        msg = JointState()\n        msg.name = f'j{n}'", "msg.name = [f'j{n}']"),
    "a number": ("msg = JointState()\n        msg.position = 0.5", "msg.position = [0.5]"),
    "a whole number": ("msg = Float32MultiArray()\n        msg.data = 3", "msg.data = [3.0]"),
    "a number in a text": ("msg = Int32MultiArray()\n        msg.data = '3'", "msg.data = [3]"),
    "by its name": ("msg = JointState(name='elbow', position=[0.5])", "msg = JointState(name=['elbow'], position=[0.5])"),
    "whole numbers in a list": ("msg = JointState()\n        msg.position = [1, 2.5]", "msg.position = [1.0, 2.5]"),
    "a list of the object": ("msg = JointState()\n        msg.position = self.steps", "self.steps = [1.0, 2.0]"),
    "numbers as names": ("msg = JointState()\n        msg.name = [1, 2]", "msg.name = ['1', '2']"),
    "floats for whole numbers": ("msg = UInt8MultiArray()\n        msg.data = [1.0, 2.0]", "msg.data = [1, 2]"),
    "one message": ("msg = Marker()\n        msg.points = Point()", "msg.points = [Point()]"),
    "the values of a dictionary": ("msg = JointState()\n        msg.position = self.angles.values()", "msg.position = [float(one) for one in self.angles.values()]"),
    "what map gives": ("msg = LaserScan()\n        msg.ranges = map(float, [1, 2])", "msg.ranges = [float(one) for one in map(float, [1, 2])]"),
    "an array of numpy": ("msg = LaserScan()\n        msg.ranges = numpy.zeros(5)", "msg.ranges = numpy.zeros(5).tolist()"),
    "one for many": ("msg = PoseWithCovariance()\n        msg.covariance = 0.1", "msg.covariance = [0.1] * 36"),
    "the diagonal, of the class": ("msg = PoseWithCovariance()\n        msg.covariance = self.NOISE", "msg.covariance = [float(one) if row == column else 0.0 for row, one in enumerate(self.NOISE) for column in range(6)]"),
    "the diagonal, written out": ("msg = Imu()\n        msg.orientation_covariance = [0.1, 0.1, 0.2]", "msg.orientation_covariance = [float(one) if row == column"),
    "the diagonal of the function": ("noise = (0.1, 0.1, 0.2)\n        msg = Imu()\n        msg.orientation_covariance = noise", "msg.orientation_covariance = [float(one) if row == column"),
    "another length": ("msg = PoseWithCovariance()\n        msg.covariance = [n / 10 for n in range(7)]", "msg.covariance = ([float(one) for one in "),
    "too many": ("msg = Imu()\n        msg.orientation_covariance = [0.1] * 12", "msg.orientation_covariance = ([float(one) for one in "),
    "too few": ("msg = PoseWithCovariance()\n        msg.covariance = [0.1, 0.2]", "msg.covariance = [0.1, 0.2, 0.0"),
}  # fmt: skip


def run(root: Path, text: str) -> str:
    """Write the program into a workspace, and return what it prints with the checks of fields on."""
    files = Files.right(NAME)
    files.put("PACKAGE/arm.py", text).write(root)
    environ = {**os.environ, "ROS_PYTHON_CHECK_FIELDS": "1"}
    return printed_by(root / files.path("PACKAGE/arm.py"), environ=environ)


@pytest.mark.parametrize(("lines", "fix"), WRONG.values(), ids=WRONG)
def test_what_is_told_is_taken(tmp_path: Path, lines: str, fix: str) -> None:
    printed = run(tmp_path, ARM.replace("LINES", lines))
    assert "must be a set or sequence" in printed, printed
    finding, *_ = of_text(printed, tmp_path)
    assert fix in finding.fix, finding
    assert "179769" not in finding.cause
    written = ARM.replace("LINES", lines).splitlines()
    number = int(finding.place.rpartition(":")[2]) - 1
    begin = written[number][: len(written[number]) - len(written[number].lstrip())]
    written[number] = begin + finding.fix.removeprefix("write ").strip("`")
    assert run(tmp_path, "\n".join(written)) == ""


ITEMS = {
    "a text": ("[('speed', 1.0), ('turns')]", ":13", "write `('turns', '')` instead of `'turns'`"),
    "a text on its line": (
        "[('speed', 1.0),\n            'turns',\n        ]",
        ":14",
        "write `('turns', '')` instead of `'turns'`",
    ),
    "the first": ("[('speed'), ('turns', 2.0)]", ":13", "write `('speed', '')` instead of `'speed'`"),
    "the only one": ("[('speed')]", ":13", "write `('speed',)` instead of `'speed'`"),
    "too long": (
        "[('speed', 1.0), ('turns', '', None, 2)]",
        ":13",
        "write `('turns', '')` instead of `('turns', '', None, 2)`",
    ),
    "of another variable": ("known", ":12", "write `('turns', '')` instead of `'turns'`"),
    "turned round": ("[('speed', 1.0), (3, 'turns')]", ":13", ""),
}
DECLARES = """\
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter


class Arm(Node):
    NUMBER = 3

    def __init__(self):
        super().__init__('arm')
        self.number = 0
        known = [('speed', 1.0), ('turns')]
        self.declare_parameters('', LIST)


rclpy.init()
Arm()
"""


@pytest.mark.parametrize(("written", "line", "fix"), ITEMS.values(), ids=ITEMS)
def test_an_item_of_another_form_is_told_by_its_index(
    tmp_path: Path, written: str, line: str, fix: str
) -> None:
    text = DECLARES.replace("LIST", written)
    finding, *_ = of_text(run(tmp_path, text), tmp_path)
    assert finding.place.endswith(line)
    assert finding.fix.partition(", with")[0] == fix
    if fix:
        old, new = (
            part.strip("`") for part in reversed(finding.fix.partition(", with")[0][6:].split(" instead of "))
        )
        changed = text.splitlines()
        number = int(line[1:]) - 1
        changed[number] = changed[number].replace(f"({old})", old).replace(old, new, 1)
        assert "index" not in run(tmp_path, "\n".join(changed))


def test_an_item_of_another_class_is_the_one_that_is_told(tmp_path: Path) -> None:
    text = DECLARES.replace(
        "self.declare_parameters('', LIST)",
        "self.declare_parameter('speed', 1.0); self.declare_parameter('turns', 1.0); self.set_parameters([Parameter('speed', value=1.0), ('turns', 2.0)])",
    )
    finding, *_ = of_text(run(tmp_path, text), tmp_path)
    assert finding.fix == "write `Parameter('turns', value=2.0)` instead of `('turns', 2.0)`"


def test_no_other_function_is_called_so_that_any_value_fits(tmp_path: Path) -> None:
    text = DECLARES.replace("LIST", "[('speed', 1.0), 'turns']")
    printed = run(tmp_path, text).replace("at index 1", "in it")
    finding, *_ = of_text(printed, tmp_path)
    assert "declare_parameter(" not in finding.fix
