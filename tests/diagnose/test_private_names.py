"""Private names that a class derived from another one takes for its own, and those that are its own."""

from __future__ import annotations

import ast
import textwrap
from pathlib import Path

import pytest

from ros2lab.diagnose.code.private_names import private_name_faults
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import read_source

BASE = """
    from rclpy.node import Node

    class Animal(Node):
        def __init__(self, name):
            super().__init__(name)
            self.__energy = 5
            self._age = 1

        def eat(self):
            self.__energy += 1
            self.__digest()

        def __digest(self):
            pass
"""


def told(body: str, folder: Path) -> NodeSources:
    base = textwrap.dedent(BASE)
    cat = "from pk.base import Animal\n\n\nclass Cat(Animal):\n    " + body
    sources = {}
    for name, text in (("base", base), ("cat", cat)):
        ast.parse(text)
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
        sources[f"pk.{name}"] = read_source(folder / f"{name}.py", f"pk.{name}", f"{name}.py")
    return NodeSources(sources)


def faults(body: str, folder: Path) -> list[Finding]:
    return [*private_name_faults(told(body, folder))]


@pytest.mark.parametrize(
    ("body", "fix"),
    [
        ("def live(self): return self.__energy", "write _energy instead of __energy"),
        ("def live(self):\n        if self.__energy < 3: self.eat()", "write _energy instead of __energy"),
        ("def rest(self): self.__digest()", "write _digest instead of __digest"),
        ("def __digest(self): print('slowly')", "write _digest instead of __digest"),
        ("def reset(self): self.__energy = 0", "write _energy instead of __energy"),
    ],
)  # fmt: skip
def test_it_is_told_whose_name_it_is(tmp_path: Path, body: str, fix: str) -> None:
    (found,) = faults(body, tmp_path)
    assert found.code == "private-name"
    assert fix in found.fix
    assert "and in base.py" in found.fix


@pytest.mark.parametrize(
    "body",
    [
        "def live(self): return self._age",
        "def live(self):\n        self.__energy = 3\n        return self.__energy",
        "def live(self):\n        self.__digest()\n    def __digest(self): pass",
        "def live(self): return self.__class__.__name__",
        "def live(self): return self._Animal__energy",
        "def live(self): self.__mood = 'good'",
        "__slots__ = ()",
    ],
)
def test_names_of_its_own_are_left_alone(tmp_path: Path, body: str) -> None:
    assert faults(body, tmp_path) == []
