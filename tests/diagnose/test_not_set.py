"""Attributes that Python does not find although a class sets them: under a private name, or not yet."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

BASE = """import rclpy
from rclpy.node import Node


class Car:
    def __init__(self):
        self.__wheels = 4


class Base(Node):
    def __init__(self):
        super().__init__('base')
        self.__speed = 0.0
        self.car = Car()
        self.greet()

    def greet(self):
        pass


class Taxi(Base):
    def __init__(self):
        super().__init__()
        self.fare = 1
        {first}
        {second}

    def on_passenger(self, msg):
        {later}
        self.left = 2


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Taxi())
"""
ROWS = [
    (("print(self.__speed)", "pass", "self.__speed = 1.0"), "_Taxi__speed", "private-name", "write _speed instead of __speed everywhere in "),
    (("pass", "pass", "print(self.car.__wheels)"), "_Taxi__wheels", "private-name", "write _wheels instead of __wheels everywhere in "),
    (("print(self.__mood)", "pass", "self.__mood = 1"), "_Taxi__mood", "attribute-missing", "set self.__mood above this line,"),
    (("print(self.mood)", "pass", "self.mood = 1"), "mood", "attribute-missing", "set self.mood above this line,"),
    (("print(self.mood)", "self.mood = 1", "pass"), "mood", "attribute-missing", "make sure that line 26 runs before this line"),
    (("self.show()", "self.trips = 1", "pass\n\n    def show(self):\n        print(self.trips)"), "trips", "attribute-missing", "set self.trips above line 25, to what show() is to begin with"),
    (("self.fuel = 2", "self.trips = 1", "pass\n\n    def greet(self):\n        print(self.trips)\n        print(self.fuel)"), "trips", "attribute-missing", "set self.trips and self.fuel above line 23, to what greet() is to begin with"),
    (("pass", "pass", "self.mood = self.mood + 1"), "mood", "attribute-missing", "set self.mood in __init__,"),
    (("self.mood: int", "pass", "print(self.mood)"), "mood", "attribute-missing", "set self.mood in __init__,"),
    (("self.mood = 1", "del self.mood", "print(self.mood)"), "mood", "attribute-unknown", "remove mood here, or define it in Taxi"),
    (("self.__speeds = 1", "pass", "print(self.__sped)"), "_Taxi__sped", "attribute-missing", "write "),
]  # fmt: skip


@pytest.mark.parametrize(("written", "name", "code", "fix"), ROWS)
def test_it_is_told_what_sets_it(
    tmp_path: Path, written: tuple[str, str, str], name: str, code: str, fix: str
) -> None:
    files = Files.right(NAMES[0])
    text = BASE.format(**dict(zip(("first", "second", "later"), written, strict=True)))
    files.texts[files.path("node")] = text
    root = files.write(tmp_path)
    reading = name.removeprefix("_Taxi")
    line = next(
        n for n, row in enumerate(text.splitlines(), 1) if f".{reading})" in row or f".{reading} +" in row
    )
    asked = "Car" if "wheels" in name else "Taxi"
    said = f"""Traceback (most recent call last):
  File "{root / files.path("node")}", line {line}, in somewhere
    {text.splitlines()[line - 1].strip()}
AttributeError: '{asked}' object has no attribute '{name}'
"""
    found = of_text(said, root)[0]
    assert found.code == code
    assert found.fix.startswith(fix)
    assert found.place.endswith(f":{line}")
