"""A None that came out of a call: told is where it comes from, and the name that holds it keeps a value."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text

NAME = NAMES[1]
ROBOT = """\
import os
import random
import re

from rclpy.task import Future


class Robot:
    def __init__(self):
        self.table = {'name': 'anna', 'speed': 'slow'}
        self.last = None
        self.words = ['b', 'a']

    def call_async(self, word):
        return Future()

    def on_word(self, msg):
        self.last = msg

    def pick(self):
        PICK


def main():
    robot = Robot()
    USE


main()
"""
# What a method does, what uses its value, and what is said: the line of the place, the cause and the fix.
FUNCTIONS = {
    "a future": (
        "self.future = self.call_async('a')\n        return self.future.result()",
        "word = robot.pick()\n    print(word.strip())",
        "return self.future.result()",
        "nothing before this waits for it",
        "write `rclpy.spin_until_future_complete(self, self.future)` above line 22",
    ),
    "a future without a name": (
        "return self.call_async('a').result()",
        "print(robot.pick().strip())",
        "return self.call_async",
        "nothing before this waits for it",
        "write `future = self.call_async('a')`, then `rclpy.spin_until_future_complete(self, future)` above line 21",
    ),
    "a key almost there": (
        "return self.table.get('Name')",
        "word = robot.pick()\n    print(word.strip())",
        "return self.table.get",
        "It has 'name'",
        "write 'name' instead of 'Name'",
    ),
    "a key that is not there": (
        "return self.table.get('colour')",
        "word = robot.pick()\n    print(word.strip())",
        "print(word.strip())",
        "returns None for a key that self.table does not have",
        "`if word is None:`",
    ),
    "a text that does not fit": (
        "return re.match(r'(\\d+)', self.words[0])",
        "word = robot.pick()\n    print(word.group(1))",
        "print(word.group(1))",
        "does not match the pattern",
        "`if word is None:`",
    ),
    "a variable of the terminal": (
        "name = os.environ.get('ROBOT_OF_NOBODY')\n        return name",
        "word = robot.pick()\n    print(word.strip())",
        "name = os.environ.get",
        "is not set",
        "type export ROBOT_OF_NOBODY=...",
    ),
    "what was not received yet": (
        "return self.last",
        "word = robot.pick()\n    print(word.strip())",
        "print(word.strip())",
        "pick() returns the None on line 11",
        "`if word is None:`",
    ),
    "a condition that does not hold": (
        "for word in self.words:\n            if word == 'c':\n                return word",
        "word = robot.pick()\n    print(word.strip())",
        "for word in self.words",
        "returns nothing when none of its conditions is true",
        "add another return at its end",
    ),
    "no return at all": (
        "self.words.pop()",
        "word = robot.pick()\n    print(word.strip())",
        "self.words.pop()",
        "because it has no return",
        "return",
    ),
    "what a function hands on that gives nothing": (
        "return self.words.sort()",
        "word = robot.pick()\n    print(word[0])",
        "return self.words.sort()",
        "returns nothing",
        "return the intended value on this line",
    ),
}
# A call that never gives anything back: the name keeps what it was made of, or with.
NOTHING = {
    "a list that is sorted": ("words = robot.words.sort()\n    print(words[0])", "write robot.words.sort() on a line of its own, and words = robot.words below it"),
    "a list that is shuffled": ("words = random.shuffle(robot.words)\n    print(words[0])", "write random.shuffle(robot.words) on a line of its own, and words = robot.words below it"),
    "what is printed": ("word = print('a')\n    print(word.strip())", "write print('a') on a line of its own, and word = 'a' below it"),
    "a dictionary that is updated": ("table = robot.table.update(a='1')\n    print(table['a'])", "write robot.table.update(a='1') on a line of its own, and table = robot.table below it"),
    "what is appended": ("a = 'a'\n    a = robot.words.append(a)\n    print(a.strip())", "write robot.words.append(a) on a line of its own, without a ="),
}  # fmt: skip


def told(root: Path, pick: str, use: str) -> tuple[Finding, list[str], str]:
    """Run a robot as a student does, and return what is said of its error, with its lines and what Python said."""
    text = ROBOT.replace("PICK", pick).replace("USE", use)
    files = Files.right(NAME)
    files.put("PACKAGE/robot.py", text).write(root)
    file = root / files.path("PACKAGE/robot.py")
    printed = run(file)
    assert "NoneType" in printed
    return of_text(printed, root)[0], text.splitlines(), printed.splitlines()[-1]


def run(file: Path) -> str:
    return subprocess.run(
        [sys.executable, file],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=60,
        check=False,
    ).stdout


@pytest.mark.parametrize("case", FUNCTIONS.values(), ids=FUNCTIONS)
def test_a_value_that_a_function_hands_on_is_followed(tmp_path: Path, case: tuple[str, ...]) -> None:
    pick, use, place, cause, fix = case
    finding, lines, _ = told(tmp_path, pick, use)
    assert lines[int(finding.place.rpartition(":")[2]) - 1].strip().startswith(place), finding
    assert cause in finding.cause, finding
    assert fix in finding.fix, finding
    assert "without" not in finding.fix


@pytest.mark.parametrize(("use", "fix"), NOTHING.values(), ids=NOTHING)
def test_a_name_is_not_lost_with_the_call_that_gives_nothing(tmp_path: Path, use: str, fix: str) -> None:
    """What is told is written: then the error is gone, and no name is missing."""
    finding, lines, error = told(tmp_path, "pass", use)
    assert finding.fix == fix
    number = int(finding.place.rpartition(":")[2]) - 1
    call, _, kept = fix.removeprefix("write ").partition(" on a line of its own, ")
    kept = kept.removeprefix("and ").removesuffix(" below it") if "below" in kept else "pass"
    lines[number : number + 1] = [f"    {call}", f"    {kept}"]
    file = tmp_path / "robot.py"
    file.write_text("\n".join(lines))
    printed = run(file)
    assert error not in printed
    assert "Error" not in printed
