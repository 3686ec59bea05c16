"""Which binding of a name holds where it is used, and names that are used as an import that another one replaced."""

from __future__ import annotations

import pytest

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.rules import text_faults
from ros2lab.diagnose.sources.python_source import PythonSource

TIME = "from rclpy.time import Time\nfrom builtin_interfaces.msg import Time"
LENGTH = "from rclpy.duration import Duration"
MESSAGE = "from builtin_interfaces.msg import Duration"


def told(imports: str, made: str, more: str = "pass") -> list[Finding]:
    """Return the findings of a node that imports names, uses them in __init__, and in a method."""
    lines = "".join(f"        {line}\n" for line in made.split("\n"))
    rest = "".join(f"        {line}\n" for line in more.split("\n"))
    text = f"import rclpy\nfrom rclpy.node import Node\n{imports}\n\n\nclass Egg(Node):\n    def __init__(self):\n        super().__init__('egg')\n{lines}\n    def more(self, given):\n{rest}\n\ndef main():\n    rclpy.init()\n    rclpy.spin(Egg())\n"
    return text_faults(PythonSource("egg", "egg.py", text))


@pytest.mark.parametrize(
    ("imports", "made", "fix"),
    [
        (
            f"{LENGTH}\n{MESSAGE}",
            "self.end = self.get_clock().now() + Duration(seconds=8)\nself.left = Duration(sec=1)",
            "write `Duration as DurationMsg` in the import on line 4, and DurationMsg instead of Duration on line 11",
        ),
        (
            TIME,
            "self.now = Time.from_msg(self.get_clock().now().to_msg())",
            "write `Time as TimeMsg` in the import on line 4",
        ),
        (
            "\n".join(reversed(TIME.split("\n"))),
            "self.now = Time(sec=1)",
            "write `Time as RclpyTime` in the import on line 4",
        ),
        (
            "from std_msgs.msg import Empty\nfrom std_srvs.srv import Empty",
            "self.create_publisher(Empty, 'a', 10).publish(Empty())\nself.create_service(Empty, 'b', lambda _, answer: answer)",
            "write `Empty as EmptySrv` in the import on line 4, and EmptySrv instead of Empty on line 11",
        ),
        (
            "from queue import Empty\nfrom std_msgs.msg import Empty",
            "try:\n    print(Empty().get_fields_and_field_types())\nexcept Empty:\n    pass",
            "write `Empty as EmptyMsg` in the import on line 4, and EmptyMsg instead of Empty on line 11",
        ),
        (
            LENGTH,
            f"{MESSAGE}\nself.limit = Duration(seconds=1)",
            "write `Duration as DurationMsg` in the import on line 9",
        ),
    ],
)
def test_a_name_that_is_used_as_what_was_replaced(imports: str, made: str, fix: str) -> None:
    (finding,) = (f for f in told(imports, made) if f.code in ("name-hidden", "message-field"))
    assert (finding.code, finding.fix) == ("name-hidden", fix)


@pytest.mark.parametrize(
    ("imports", "made", "more"),
    [
        (LENGTH, "self.limit = Duration(seconds=1)", f"{MESSAGE}\nself.left = Duration(sec=1)"),
        (MESSAGE, "self.limit = Duration(sec=1)", f"{LENGTH}\nself.left = Duration(seconds=1)"),
        (
            f"from typing import TYPE_CHECKING\n{LENGTH}\nif TYPE_CHECKING:\n    {MESSAGE}",
            "self.limit = Duration(seconds=1)",
            "pass",
        ),
        (
            f"try:\n    {LENGTH}\nexcept ImportError:\n    {MESSAGE}",
            "self.limit = Duration(seconds=1)",
            "pass",
        ),
        (MESSAGE, "Duration = dict\nself.limit = Duration(seconds=1)", "pass"),
        (MESSAGE, "self.limit = (lambda Duration: Duration(seconds=1))(dict)", "pass"),
        (
            MESSAGE,
            "self.limit = Duration(sec=1)",
            "def Duration(seconds):\n    return seconds\nself.left = Duration(seconds=1)",
        ),
        (
            f"{MESSAGE}\n\n\nclass Limits:\n    {LENGTH}\n    LONG = Duration(seconds=1)\n\n    def left(self):\n        return Duration(sec=2)",
            "self.limit = Limits().left()",
            "pass",
        ),
        (f"{LENGTH}\n{MESSAGE}", "self.limit = Duration(sec=1)", "pass"),
    ],
)
def test_the_binding_that_holds_at_a_place(imports: str, made: str, more: str) -> None:
    assert told(imports, made, more) == []


KEEP = "\n\ndef keep(function):\n    return lambda self: next(function(self))\n"
BLINK = "\n    def blink(self):\n        yield 1\n"


@pytest.mark.parametrize(
    ("made", "body", "is_told"),
    [
        ("self.create_timer(1.0, self.blink)", BLINK, True),
        ("self.create_timer(1.0, self.blink)", BLINK.replace("    def", "    @keep\n    def"), False),
        ("self.create_timer(1.0, self.blink)", f"{BLINK}\n    blink = keep(blink)\n", False),
        ("self.blink = keep(self.blink)\nself.create_timer(1.0, self.blink)", BLINK, False),
        ("blink = 3\nself.create_timer(1.0, self.blink)\nprint(blink)", BLINK, True),
    ],
)
def test_a_function_that_is_wrapped_is_not_judged_by_its_body(made: str, body: str, is_told: bool) -> None:
    lines = made.replace("\n", "\n        ")
    text = f"import rclpy\nfrom rclpy.node import Node\n{KEEP}\n\nclass Egg(Node):\n    def __init__(self):\n        super().__init__('egg')\n        {lines}\n{body}"
    codes = [finding.code for finding in text_faults(PythonSource("egg", "egg.py", text))]
    assert ("never-called" in codes) == is_told
    wrapped = text.replace("class Egg", "@keep\nclass Egg")
    assert "never-called" not in [f.code for f in text_faults(PythonSource("egg", "egg.py", wrapped))]


@pytest.mark.parametrize(
    ("made", "fix"),
    [
        ("Node.create_timer(self, 1.0, self.get_name)", ""),
        ("Node.create_publisher(self, String, 'a', 10).publish(String())", ""),
        ("super(Egg, self).create_publisher(String, 'a', 10).publish(String())", ""),
        ("partial(Node.create_publisher, self)(String, 'a', 10).publish(String())", ""),
        ("LifecycleNode.create_subscription(self, String, 'a', print, 10)", ""),
        (
            "Node.create_publisher(self, String, 'a').publish(String())",
            "write `Node.create_publisher(self, String, 'a', 10)`",
        ),
    ],
)
def test_a_method_that_is_called_by_its_class(made: str, fix: str) -> None:
    imports = "from functools import partial\nfrom rclpy.lifecycle import LifecycleNode\nfrom std_msgs.msg import String"
    assert [finding.fix for finding in told(imports, made)] == ([fix] if fix else [])
