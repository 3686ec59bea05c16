"""Objects of which only a base class is known: what they have, and what no class of theirs has."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

TALK = "        self.count += 1\n"
TOP = """\
import json
import logging
import subprocess
from pathlib import Path


class Shape:
    def area(self):
        return 1.0


class Circle(Shape):
    def __init__(self):
        self.radius = 1.0

    def area(self, scale=1.0):
        return scale

    def __add__(self, other):
        return self


def made() -> Shape:
    return Circle()


"""
RIGHT = {
    "handler": "try:\n    subprocess.run(['ls'], check=True)\nexcept Exception as error:\n    self.why = error.stderr",
    "handler of several": "try:\n    open('a')\nexcept (OSError, Exception) as error:\n    self.why = error.strerror",
    "handler of a base": "try:\n    json.loads('{')\nexcept ValueError as error:\n    self.why = error.msg",
    "factory": "self.size = made().radius",
    "kept": "shape = made()\nself.size = shape.radius",
    "hint of a list": "shapes: list[Shape] = [Circle()]\nself.sizes = [shape.radius for shape in shapes]",
    "hint of a node": "nodes: list[Node] = [self]\nself.get_logger().info(f'{[node.count for node in nodes]}')",
    "isinstance": "for thing in getattr(self, 'things', ()):\n    if isinstance(thing, Shape) and thing.area():\n        self.size = thing.radius",
    "method of its own": "self.size = made().area(2.0)",
    "operator of its own": "self.size = made() + 1",
    "of a library": "self.name = logging.getLogger().handlers[0].baseFilename",
}
WRONG = {
    "made here": "shape = Shape()\nself.size = shape.radius",
    "in no class below": "self.size = made().colour",
    "message": "msg = String()\nself.size = msg.radius",
    "plain": "self.size = 'a'.radius",
    "of the library alone": "self.size = self.get_clock().radius",
    "path": "self.size = Path.home().radius",
    "handler of a class without others": "try:\n    subprocess.run(['ls'])\nexcept subprocess.CalledProcessError as error:\n    self.why = error.stdrr",
}


def told(line: str, root: Path) -> list[str]:
    files = Files.right(NAMES[1]).change("node", TALK, TALK + textwrap.indent(f"{line}\n", " " * 8))
    files.change("node", "class CLASS", f"{TOP}class CLASS")
    return [finding.code for finding in of_workspace(files.write(root))]


@pytest.mark.parametrize("way", RIGHT)
def test_what_a_class_below_has_is_not_missing(tmp_path: Path, way: str) -> None:
    assert told(RIGHT[way], tmp_path) == []


@pytest.mark.parametrize("way", WRONG)
def test_what_no_class_below_has_is_told(tmp_path: Path, way: str) -> None:
    assert len(told(WRONG[way], tmp_path)) == 1
