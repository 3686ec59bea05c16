"""Classes that nothing names may be made by a registry; those that nothing can make are told."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_workspace

MADE = "    node = StatusPublisher()\n"
CLASS = "class StatusPublisher(Node):\n"
BASE = "class Base(Node):\n    kinds = []\n\n    def __init_subclass__(cls, **words):\n        super().__init_subclass__(**words)\n        Base.kinds.append(cls)\n\n\n"
META = "class Kept(type(Node)):\n    kinds = {}\n\n    def __init__(cls, *given):\n        super().__init__(*given)\n        Kept.kinds[cls.__name__.lower()] = cls\n\n\n"
DECORATOR = "KINDS = {}\n\n\ndef register(cls):\n    KINDS['status'] = cls\n    return cls\n\n\n@register\n"

RIGHT = {
    "a base class that keeps its subclasses": (BASE + CLASS.replace("Node", "Base"), "    node = [kind() for kind in Base.kinds][0]\n"),
    "a decorator": (DECORATOR + CLASS, "    node = KINDS['status']()\n"),
    "a metaclass": (META + CLASS.replace("(Node)", "(Node, metaclass=Kept)"), "    kind = Kept.kinds['statuspublisher']\n    node = kind()\n"),
    "the subclasses of a base": ("class Base(Node):\n    pass\n\n\n" + CLASS.replace("Node", "Base"), "    node = [kind() for kind in Base.__subclasses__()][0]\n"),
    "the names of the file": (CLASS, "    node = globals()['Status' + 'Publisher']()\n"),
    "the module": (CLASS, "    node = getattr(__import__(__name__, fromlist=['x']), 'Status' + 'Publisher')()\n"),
    "a function that makes what it is given": ("def make(kind):\n    return kind()\n\n\n" + CLASS, "    node = make(vars()[''] if args else [*map(globals().get, ['Status' + 'Publisher'])][0])\n"),
}  # fmt: skip
WRONG = {
    "a plain node": (CLASS, "    node = rclpy.create_node('status_publisher')\n"),
    "a plain node beside functions": ("def named(text):\n    return str(text).lower()\n\n\n" + CLASS, "    node = rclpy.create_node(named('Status_Publisher'))\n"),
    "a plain node and a lambda": (CLASS, "    node = rclpy.create_node('status_publisher')\n    node.create_timer(1.0, lambda: print('tick'))\n"),
    "a data class of Python": ("from dataclasses import dataclass\n\n\n@dataclass\nclass Place:\n    x: float = 0.0\n\n\n" + CLASS, "    node = rclpy.create_node('status_publisher')\n    print(Place())\n"),
}  # fmt: skip


@pytest.mark.parametrize("name", [*RIGHT, *WRONG])
def test_a_class_that_a_value_may_stand_for_is_not_said_to_be_never_made(tmp_path: Path, name: str) -> None:
    before, made = (RIGHT | WRONG)[name]
    files = right_workspace().change("node", CLASS, before).change("node", MADE, made)
    codes = [finding.code for finding in of_workspace(files.write(tmp_path))]
    assert codes.count("never-made") == (name in WRONG)
