"""A def without a parameter, a literal of another type, a value instead of a function: the told line restores it.

The unseen neighbours of a slip are rows: what is written instead of what, in a program that is run for real.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from one_file import printed_by, sources_of
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text
from ros2lab.diagnose.code.lost_parameters import lost_parameters
from ros2lab.diagnose.nodes.node_faults import node_faults

PROGRAM = """\
import threading
from collections import namedtuple
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from std_msgs.msg import Float64, Float64MultiArray, Int32

Joint = namedtuple('Joint', 'name low high')


@dataclass
class Tank:
    litres: float
    places: int = 2


def doubled(number):
    return number * 2


class Base:
    ROWS, STEP = 4, 0.5
    JOINTS = [Joint('base', -3, 3), Joint('wrist', -1, 1)]

    def __init__(self, queue, *args, **kwargs):
        self.queue = queue
        self.extra = (args, kwargs)
        self.count = 0
        self.tank = Tank(1.5, 3)
        self.level: float = 20.0
        self.jobs = ThreadPoolExecutor(2)

    def push(self, word, times=1):
        self.queue.extend([word] * times)
        self.count += 1
        return self.count

    def reset(self):
        self.queue.clear()

    def level_of(self, name):
        return {'high': self.level}[name]


def main():
    queue = []
    base = Base(queue, 1, daemon=True)
    base.push('a', base.tank.places)
    Int32(data=base.ROWS)
    Int32(data=base.push('b'))
    Float64(data=base.level_of('high'))
    Float64(data=base.tank.litres)
    Float64MultiArray(data=[base.STEP] * 3)
    spread = [joint.high - joint.low for joint in base.JOINTS]
    Int32(data=base.jobs.submit(doubled, base.ROWS).result())
    base.reset()
    print('well', spread)


main()
"""
SLIPS = {
    "__init__ without self": ("def __init__(self, queue", "def __init__(queue"),
    "a method without self": ("def push(self, word, times=1)", "def push(word, times=1)"),
    "a method without anything": ("def reset(self)", "def reset()"),
    "no parameters but self": ("def __init__(self, queue, *args, **kwargs)", "def __init__(self)"),
    "a parameter less": ("def level_of(self, name)", "def level_of(self)"),
    "a function without its parameter": ("def doubled(number)", "def doubled()"),
    "another name than in the body": ("def level_of(self, name)", "def level_of(self, names)"),
    "a string in a tuple of the class": ("ROWS, STEP = 4,", "ROWS, STEP = '4',"),
    "a string where floats are held": ("4, 0.5", "4, '0.5'"),
    "a float that is counted on": ("self.count += 1", "self.count += 1.0"),
    "a float to begin with": ("self.count = 0", "self.count = 0.0"),
    "an int with an annotation": ("self.level: float = 20.0", "self.level: float = 20"),
    "an int for a dataclass": ("Tank(1.5, 3)", "Tank(1, 3)"),
    "a string for a dataclass": ("Tank(1.5, 3)", "Tank('1.5', 3)"),
    "a float that repeats": ("Tank(1.5, 3)", "Tank(1.5, 3.0)"),
    "two arguments swapped": ("Joint('wrist', -1, 1)", "Joint(-1, 'wrist', 1)"),
    "a string in a named tuple": ("Joint('wrist', -1, 1)", "Joint('wrist', '-1', 1)"),
    "a value before the function": ("submit(doubled, base.ROWS)", "submit(base.ROWS, doubled)"),
    "a call instead of a function": ("submit(doubled, base.ROWS)", "submit(doubled(base.ROWS))"),
}


@pytest.mark.parametrize(("right", "wrong"), SLIPS.values(), ids=SLIPS)
def test_the_told_line_restores_the_program(tmp_path: Path, right: str, wrong: str) -> None:
    files = Files.right(NAMES[1])
    files.put("PACKAGE/robot.py", PROGRAM.replace(right, wrong)).write(tmp_path)
    file = tmp_path / files.path("PACKAGE/robot.py")
    printed = printed_by(file)
    assert "Error" in printed
    finding = of_text(printed, tmp_path)[0]
    told = re.match(r"write `(.+?)`", finding.fix)
    assert told, finding
    number = int(finding.place.rpartition(":")[2]) - 1
    lines = file.read_text().splitlines()
    begin = lines[number][: len(lines[number]) - len(lines[number].lstrip())]
    whole = f"{begin}{told[1]}"
    if lines[number].lstrip().startswith("Int32("):
        whole = f"{begin}Int32(data={told[1]}.result())"  # only the call inside is told
    lines[number] = whole
    file.write_text("\n".join(lines))
    assert printed_by(file).startswith("well"), finding


RIGHT = {
    "a static method": "class A:\n    @staticmethod\n    def twice(number):\n        return number * 2\n",
    "a helper of the class body": "class A:\n    def table(size):\n        return [0] * size\n    ROWS = table(3)\n",
    "another word for self": "class A:\n    def __init__(this):\n        this.n = 1\n    def on(self):\n        return self\n",
    "a class method": "class A:\n    def __new__(cls):\n        return object.__new__(cls)\n    def on(self):\n        pass\n",
    "self of the function around": "class A:\n    def on(self):\n        def inner():\n            return self\n        return inner\n",
    "names of the file": "def on():\n    return LATER\n\n\nLATER = 1\non()\n",
    "a global that another function sets": "def begin():\n    global node\n    node = 1\n\n\ndef on(x):\n    return node\n\n\non(1)\n",
    "a property": "class A:\n    @property\n    def on(self):\n        return 1\n    @on.setter\n    def on(self, value):\n        self.n = value\n",
}


@pytest.mark.parametrize("text", RIGHT.values(), ids=RIGHT)
def test_right_defs_are_left_alone(tmp_path: Path, text: str) -> None:
    assert not [*lost_parameters(sources_of(text, tmp_path))]


NODE = """\
from rclpy.node import Node
from std_msgs.msg import String


class Talk(Node):
    def __init__(self):
        super().__init__('talk')
        self.kind = String
        self.out = self.create_publisher(String, 'words', 10)
        CALL

    def on_word(self, msg):
        self.out.publish(msg)
"""
CALLS = {
    "self.create_subscription('words', String, self.on_word, 10)": "String, 'words', self.on_word, 10",
    "self.create_subscription('words', self.kind, self.on_word, 10)": "self.kind, 'words', self.on_word, 10",
    "self.create_subscription('words', self.on_word, 10)": "String, 'words', self.on_word, 10",
    "self.create_subscription(String, self.on_word, 10)": "String, 'words', self.on_word, 10",
    "self.create_subscription(String, 'words', 10)": "String, 'words', self.on_word, 10",
}


@pytest.mark.parametrize(("call", "right"), CALLS.items())
def test_a_creation_keeps_its_own_arguments(tmp_path: Path, call: str, right: str) -> None:
    found = [*node_faults(sources_of(NODE.replace("CALL", call), tmp_path))]
    assert [finding.fix for finding in found] == [f"write `self.create_subscription({right})`"]


def test_a_missing_callback_is_no_list_and_no_other_method(tmp_path: Path) -> None:
    text = NODE.replace("CALL", "self.create_timer(0.5)").replace(
        "def on_word(self, msg)", "def out_(self, msg)"
    )
    text += "\n    def again(self):\n        self.out_(1)\n"
    (finding,) = node_faults(sources_of(text.replace("def again", "def tick"), tmp_path))
    assert finding.fix == "write `self.create_timer(0.5, self.tick)`"
