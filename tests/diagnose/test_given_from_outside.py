"""Attributes that other code gives a node, and those that nothing gives it."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose.look import Look

TOP, BEGUN, USED = "\n\nclass StatusPublisher", "        self.count = 0\n", "        self.count += 1\n"
# What stands above the class and in its constructor, for each name what reads the attribute.
GIVEN = {
    "model of a state machine": ("from transitions import Machine", "self.machine = Machine(model=self)"),
    "one model of several": ("from transitions import Machine", "self.machine = Machine(model=[self])"),
    "method of foreign object": ("from helper import Kit", "self.kit = Kit()\n        self.kit.attach(self)"),
    "form": ("from PyQt5 import uic", "uic.loadUi('a.ui', self)"),
    "mapping": ("", "self.__dict__.update(speed=1.0)"),
    "vars": ("", "vars(self).update(speed=1.0)"),
    "own function": ("def attach(node):\n    node.speed = 1.0\n", "attach(self)"),
    "own function, by name": ("def attach(node):\n    setattr(node, 'speed', 1.0)\n", "attach(self)"),
    "own functions in turn": ("def fill(to):\n    to.speed = 1.0\n\n\ndef attach(node):\n    fill(node)\n", "attach(self)"),
    "own class": ("class Kit:\n    def __init__(self, node):\n        self.node = node\n        self.node.speed = 1.0\n", "self.kit = Kit(self)"),
    "base of foreign code": ("from helper import Kit\n\n\nclass Base(Node):\n    def __init__(self, name):\n        super().__init__(name)\n        Kit(self)\n", ""),
    "decorator": ("from helper import with_speed\n\n\n@with_speed", ""),
    "main": ("", ""),
}  # fmt: skip
HARMLESS = {
    "printed": ("", "print(self)"),
    "listener": ("from tf2_ros import Buffer, TransformListener", "self.buffer = Buffer()\n        self.tf = TransformListener(self.buffer, self)"),
    "executor": ("from rclpy.executors import SingleThreadedExecutor", "executor = SingleThreadedExecutor()\n        executor.add_node(self)"),
    "own function": ("def attach(node):\n    node.pace = 1.0\n", "attach(self)"),
    "message": ("", "m = String()\n        m.speed = 1.0"),
    "nothing": ("", "pass"),
}  # fmt: skip


def told(folder: Path, top: str, begun: str, main: str = "", base: str = "Node") -> list[str]:
    """Return what is said of an attribute that only the code at the top and in the constructor can set."""
    gap = "\n" if top.endswith("@with_speed") else "\n\n\n"
    files = right_workspace().change("node", TOP, f"\n\n{top}{gap}class StatusPublisher")
    files.change("node", "StatusPublisher(Node)", f"StatusPublisher({base})")
    files.change("node", BEGUN, f"{BEGUN}        {begun or 'pass'}\n")
    files.change("node", USED, f"{USED}        self.get_logger().info(str(self.speed))\n")
    files.change("node", "    node = StatusPublisher()\n", f"    node = StatusPublisher()\n{main}")
    found = Look(files.write(folder)).findings
    return [finding.cause for finding in found if finding.code == "attribute-missing"]


@pytest.mark.parametrize("way", GIVEN)
def test_an_attribute_that_other_code_may_give_is_not_missing(tmp_path: Path, way: str) -> None:
    main = "    node.speed = 1.0\n" if way == "main" else ""
    assert told(tmp_path, *GIVEN[way], main, "Base" if "class Base" in GIVEN[way][0] else "Node") == []


@pytest.mark.parametrize("way", HARMLESS)
def test_an_attribute_that_nothing_gives_is_missing(tmp_path: Path, way: str) -> None:
    assert any("speed" in cause for cause in told(tmp_path, *HARMLESS[way]))
