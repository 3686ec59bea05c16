"""Callbacks that only they themselves would register, or a method that nothing calls; and those that do begin."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.finding import Finding

NODE = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger


class Tea(Node):
    def __init__(self):
        super().__init__('tea')
        self.count = 0
        BEGIN

    BODY


def main(args=None):
    rclpy.init(args=args)
    node = Tea()
    AFTER
    rclpy.spin(node)
"""
TICK = "def tick(self):\n    self.count += 1\n    self.timer = self.create_timer(0.5, self.tick)"
HEARD = (
    "def heard(self, msg):\n    self.count += 1\n    self.create_subscription(String, 'tea', self.heard, 10)"
)
TWO = "def ping(self):\n    self.count += 1\n    self.a = self.create_timer(1.0, self.pong)\n\ndef pong(self):\n    self.count -= 1\n    self.b = self.create_timer(1.0, self.ping)"
SETUP = "def set_up(self):\n    self.timer = self.create_timer(0.5, self.tick)\n\ndef tick(self):\n    self.count += 1"
CODES = ("never-called", "timer-in-callback", "made-again")


def found_in(root: Path, body: str, begin: str = "pass", after: str = "pass") -> list[Finding]:
    code = NODE.replace("BODY", body.replace("\n", "\n    ")).replace("BEGIN", begin).replace("AFTER", after)
    found = of_workspace(Files.right(NAMES[0]).put("node", code.replace("\n    \n", "\n\n")).write(root))
    return [finding for finding in found if finding.code in CODES]


@pytest.mark.parametrize(
    ("body", "fix"),
    [
        (TICK, "move line 15 to the end of __init__"),
        (HEARD, "move line 15 to the end of __init__"),
        (TWO, "move lines 15 and 19 to the end of __init__"),
        (SETUP, "write `self.set_up()` at the end of __init__"),
    ],
)
def test_what_nothing_begins_is_told(tmp_path: Path, body: str, fix: str) -> None:
    (found,) = found_in(tmp_path, body)
    assert (found.code, found.fix) == ("never-called", fix)


@pytest.mark.parametrize(
    ("body", "begin", "after", "codes"),
    [
        (TICK, "self.tick()", "pass", ["timer-in-callback"]),
        (TICK, "pass", "node.tick()", ["timer-in-callback"]),
        (TICK, "getattr(self, 'tick')()", "pass", ["timer-in-callback"]),
        (TWO, "self.c = self.create_timer(1.0, self.ping)", "pass", ["timer-in-callback"] * 2),
        (SETUP, "self.set_up()", "pass", []),
        (SETUP, "pass", "node.set_up()", []),
    ],
)
def test_what_something_begins_is_called(
    tmp_path: Path, body: str, begin: str, after: str, codes: list[str]
) -> None:
    found = found_in(tmp_path, body, begin, after)
    assert [finding.code for finding in found] == codes
    for finding in found:  # it may be meant to go on, or as a delay
        assert "if it is to fire again and again" in finding.fix
        assert "cancel it in its own callback" in finding.fix


BASE = NODE.replace("BODY", "def reset(self):\n        self.out.publish(String())").replace("AFTER", "pass")
BASE = BASE.replace("BEGIN", "self.out = self.create_publisher(String, 'tea', 10)")
DERIVED = "from {} import Tea\n\n\nclass Green(Tea):\n    pass\n"


@pytest.mark.parametrize(
    ("name", "other", "is_told"),
    [
        ("", "", True),
        ("PACKAGE/green.py", DERIVED.format("PACKAGE.MODULE"), False),
        ("PACKAGE/green.py", DERIVED.format("MODULE"), False),
        ("PACKAGE/green.py", "from PACKAGE.MODULE import main\n\nmain()\n", True),
        ("../shop/shop/sell.py", "from PACKAGE.MODULE import Tea\n\nprint(Tea)\n", False),
    ],
)
def test_a_class_that_others_inherit_or_import_is_theirs_to_use(
    tmp_path: Path, name: str, other: str, *, is_told: bool
) -> None:
    files = Files.right(NAMES[0]).put("node", BASE)
    if name:
        files.put(name, other)
    if name.startswith("../shop"):
        about = "<package format='3'>\n  <name>shop</name>\n  <export><build_type>ament_python</build_type></export>\n</package>\n"
        files.put("../shop/package.xml", about)
        files.put(
            "../shop/setup.py", "from setuptools import setup\n\nsetup(name='shop', packages=['shop'])\n"
        )
        files.put("../shop/shop/__init__.py", "")
    found = [one.code for one in of_workspace(files.write(tmp_path))]
    assert ("never-called" in found) is is_told


BY_MEMBERS = "for name in dir(self):\n            if name.startswith('on_'):\n                self.create_subscription(String, name, METHOD, 10)"
ON_TEA = "def on_tea(self, msg):\n    self.count += 1"


@pytest.mark.parametrize(
    ("begin", "is_told"),
    [
        (BY_MEMBERS.replace("METHOD", "getattr(self, name)"), False),
        ("for name, method in inspect.getmembers(self):\n            print(name, method)", False),
        ("self.create_subscription(String, 'a', getattr(self, 'on_' + self.get_name()), 10)", False),
        ("for name in vars(type(self)):\n            print(name)", False),
        ("print(type(self).__dict__)", False),
        ("print(getattr(self, 'count'))", True),
        ("pass", True),
    ],
)
def test_what_goes_through_all_members_may_register_any(tmp_path: Path, begin: str, *, is_told: bool) -> None:
    assert [finding.code for finding in found_in(tmp_path, ON_TEA, begin)] == ["never-called"] * is_told
