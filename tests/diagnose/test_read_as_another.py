"""Parameters that are read as another type: the place is changed that nothing else needs as it is."""

from __future__ import annotations

import textwrap

import pytest

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.rules import text_faults
from ros2lab.diagnose.sources.python_source import PythonSource

TEXT = """\
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray, Int32, String


class Mower(Node):
    def __init__(self):
        super().__init__('mower')
        self.declare_parameter('p', DEFAULT)
        self.create_timer(0.1, self.drive)

    def drive(self):
        v = READ.FIELD
        msg = Twist()
"""
READ = "self.get_parameter('p').get_parameter_value()"
TO_FLOAT, TO_INT = "msg.linear.x = v", "self.pub.publish(Int32(data=v))"


def found(default: str, field: str, use: str, read: str = READ) -> list[Finding]:
    text = TEXT.replace("DEFAULT", default).replace("READ", read).replace("FIELD", field)
    faults = text_faults(PythonSource("pk.mower", "mower.py", text + textwrap.indent(use, " " * 8)))
    return [fault for fault in faults if fault.code == "parameter-type"]


@pytest.mark.parametrize(
    ("default", "field", "use", "fix"),
    [
        ("1", "double_value", TO_FLOAT, "write 1.0 instead of 1"),
        ("1", "double_value", "self.create_timer(v, self.drive)", "write 1.0 instead of 1"),
        ("1", "double_value", "print(v)", "write 1.0 instead of 1"),
        ("1.0", "integer_value", "for one in range(v):\n    print(one)", "write 1 instead of 1.0"),
        ("1.0", "integer_value", TO_INT, "write 1 instead of 1.0"),
        ("1.0", "integer_value", "print(1 / v)", "write .double_value instead of .integer_value"),
        ("0.5", "integer_value", TO_INT, "write .double_value instead of .integer_value"),
        ("'3'", "integer_value", TO_INT, "write 3 instead of '3'"),
        ("'three'", "integer_value", TO_INT, "write .string_value instead of .integer_value"),
        ("True", "string_value", "self.pub.publish(String(data=v))", "write 'True' instead of True"),
        ("[1, 2]", "double_array_value", "self.pub.publish(Float64MultiArray(data=v))", "write [1.0, 2.0] instead of [1, 2]"),
    ],
)  # fmt: skip
def test_what_is_changed_is_what_nothing_else_needs(default: str, field: str, use: str, fix: str) -> None:
    (fault,) = found(default, field, use)
    assert fault.fix == fix
    assert fault.place == ("mower.py:13" if fix.startswith("write .") else "mower.py:9")


@pytest.mark.parametrize(
    ("read", "is_told"),
    [
        ("self.get_parameter('p').get_parameter_value()", True),
        ("self.declare_parameter('p', 1).get_parameter_value()", True),
        ("self.get_parameter('q').get_parameter_value()", False),
        ("self.get_parameter(self.name).get_parameter_value()", False),
        ("self.mine", False),
    ],
)
def test_how_a_parameter_is_read(read: str, is_told: bool) -> None:
    assert bool(found("1", "double_value", TO_FLOAT, read)) is is_told


@pytest.mark.parametrize(
    ("default", "field"), [("1.0", "double_value"), ("[1]", "integer_array_value"), ("DEPTH", "double_value")]
)
def test_a_field_of_its_type_is_no_alarm(default: str, field: str) -> None:
    assert not found(default, field, TO_FLOAT)
