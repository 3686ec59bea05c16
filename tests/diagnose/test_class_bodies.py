"""Errors that come as a class is made: the place is the field's line, and what is told is written there."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import printed_by

from ros2lab.diagnose import of_text

TOP = """\
import dataclasses
from collections import namedtuple
from dataclasses import dataclass
from enum import Enum, unique
from typing import NamedTuple


class Point:
    __hash__ = None


"""
MUTABLE = (
    "@dataclass\nclass Tour:\n    name: str = ''\n    points: {}\n\n    def length(self):\n        return 1"
)
# A class, the line to change, and what is to stand there.
WRITTEN = {
    "a list": (MUTABLE.format("list = []"), "points", "points: list = field(default_factory=list)"),
    "a dictionary": (MUTABLE.format("dict = {}"), "points", "points: dict = field(default_factory=dict)"),
    "a set": (MUTABLE.format("set = set()"), "points", "points: set = field(default_factory=set)"),
    "a list with something in it": (MUTABLE.format("list = [1, 2]"), "points", "points: list = field(default_factory=lambda: [1, 2])"),
    "an object": (MUTABLE.format("Point = Point()"), "points", "points: Point = field(default_factory=Point)"),
    "by the module": (MUTABLE.format("list = []").replace("@", "@dataclasses."), "points", "points: list = field(default_factory=list)"),
    "no type": ("@dataclass\nclass Tour:\n    name: str = ''\n    points = dataclasses.field(default_factory=list)", "points", "points: list = dataclasses.field(default_factory=list)"),
    "late, of a class with defaults": ("@dataclass\nclass A:\n    speed: float = 0.5\n\n\n@dataclass\nclass Tour(A):\n    name: str\n    count: int = 1", "name", "name: str = ''"),
    "the order of the bases": ("class A:\n    pass\n\n\nclass B(A):\n    pass\n\n\nclass C(A, B):\n    pass", "class C", "class C(B, A):"),
    "one base twice": ("class A:\n    pass\n\n\nclass C(A, A):\n    pass", "class C", "class C(A):"),
}  # fmt: skip
# The same where there is a choice, or the line is to be moved.
TOLD = {
    "late": ("@dataclass\nclass Tour:\n    speed: float = 0.5\n    name: str", "name: str", "move this line above line 14"),
    "late, in a named tuple": ("class Tour(NamedTuple):\n    speed: float = 0.5\n    name: str", "name: str", "move this line above line 13"),
    "a member twice": ("class Colour(Enum):\n    RED = 1\n    GREEN = 2\n    RED = 3", "RED = 3", "give it another name"),
    "a value twice": ("@unique\nclass Colour(Enum):\n    RED = 1\n    GREEN = 1", "GREEN = 1", "give GREEN another value"),
    "a name with _": ("class Tour(NamedTuple):\n    _speed: float", "_speed", "write speed instead of _speed"),
    "a word of Python's": ("Tour = namedtuple('Tour', 'name class')", "Tour =", "write class_ instead of class"),
    "an Enum of an Enum": ("class Colour(Enum):\n    RED = 1\n\n\nclass More(Colour):\n    BLUE = 2", "class More", "write Enum instead of Colour"),
    "frozen": ("@dataclass(frozen=True)\nclass A:\n    speed: float\n\n\n@dataclass\nclass Tour(A):\n    name: str", "@dataclass", "write @dataclass(frozen=True) above the class Tour"),
    "slots": ("class Tour:\n    __slots__ = ('name', 'speed')\n    speed = 1", "speed = 1", "set self.speed in __init__"),
}  # fmt: skip


def run(folder: Path, text: str) -> str:
    file = folder / "tour.py"
    file.write_text(text)
    return printed_by("-I", file)


@pytest.mark.parametrize(("code", "begin", "new"), WRITTEN.values(), ids=WRITTEN)
def test_the_field_is_written_as_it_is_told(tmp_path: Path, code: str, begin: str, new: str) -> None:
    lines = f"{TOP}{code}\n".splitlines()
    (finding,) = of_text(run(tmp_path, f"{TOP}{code}\n"))
    number = int(finding.place.rpartition(":")[2]) - 1
    assert lines[number].strip().startswith(begin), finding
    fix, _, needed = finding.fix.removeprefix("write ").partition(", with `")
    assert fix.replace("dataclasses.field", "field") == new.replace("dataclasses.field", "field")
    lines[number] = f"{lines[number][: -len(lines[number].lstrip())]}{fix}"
    top = needed.partition("`")[0]
    assert run(tmp_path, "\n".join([top, *lines])) == ""


@pytest.mark.parametrize(("code", "begin", "fix"), TOLD.values(), ids=TOLD)
def test_the_line_of_the_field_is_told(tmp_path: Path, code: str, begin: str, fix: str) -> None:
    lines = f"{TOP}{code}\n".splitlines()
    (finding,) = of_text(run(tmp_path, f"{TOP}{code}\n"))
    assert lines[int(finding.place.rpartition(":")[2]) - 1].strip().startswith(begin), finding
    assert fix in finding.fix, finding
    assert "print the values" not in finding.fix


@pytest.mark.parametrize(
    "code",
    [
        "@dataclass\nclass Tour:\n    name: str = ''\n\n    def go(self):\n        return int('a')\n\n\nTour().go()",
        "@dataclass\nclass Tour:\n    name: str\n\n\nTour()",
        "class Tour:\n    speed = int('a')",
    ],
)
def test_what_is_no_fault_of_the_class_is_not_told_as_one(tmp_path: Path, code: str) -> None:
    found = of_text(run(tmp_path, f"{TOP}{code}\n"))
    assert all("cannot be created" not in one.cause and one.code != "made-wrong" for one in found)
