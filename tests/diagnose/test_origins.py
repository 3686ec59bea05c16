"""What fails where it is used is mended where it was made: real errors of Python, and the fix typed as it is told."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from one_file import printed_by

from ros2lab.diagnose import of_text

ROBOT = """\
import datetime
import random
import time


class Message:
    def __init__(self):
        self.data = ''


class Robot:
    def __init__(self):
        self.count = 0
        self.words = ['b', 'a']

    def text(self):
        return f'robot {self.count}'

    def tick(self):
        message = Message()
        message.data = self.text().upper()
        self.count += 1
        now = time.time()
        return message.data + self.words[0]


robot = Robot()
print(robot.tick(), robot.tick())
"""
# What is right, and what stands in its place; the fix is a line to write where the place is.
TYPED = {
    "a text for a number": ("self.count = 0", "self.count = '0'"),
    "a text by str()": ("self.count = 0", "self.count = str(0)"),
    "a text that was read": ("self.count = 0", "self.count = input()"),
    "no return": ("return f'robot {self.count}'", "f'robot {self.count}'"),
    "a module for its function": ("now = time.time()", "now = time()"),
    "a module for its class": ("now = time.time()", "now = datetime.now()"),
    "a class for an object": ("self.words = ['b', 'a']", "self.words = Message\n        self.words[0]"),
    "a dict for a list": ("now = time.time()", "self.words = {}\n        self.words.append('a')"),
}
# The same where the fix is more than one line, or leaves a choice: what it says, and the line that it speaks of.
TOLD = {
    "None": ("self.count = 0", "self.count = None", "give it the value that line", "self.count = None"),
    "what print gives": ("self.count = 0", "self.count = print(0)", "write print(0) on a line of its own", "print(0)"),
    "what sort gives": (
        "self.words = ['b', 'a']",
        "self.words = ['b', 'a'].sort()",
        "write self.words = ['b', 'a'], and self.words.sort()",
        ".sort()",
    ),
    "what append gives": (
        "self.words = ['b', 'a']",
        "words = []\n        self.words = words.append('a')",
        "write words.append('a') on a line of its own",
        ".append('a')",
    ),
    "a method that is kept": ("self.words = ['b', 'a']", "self.words = self.text", "write self.words = self.text(...)", "self.text\n"),
    "a function for its module": (
        "import random\n",
        "from random import random\nCHANCE = random.randint(1, 2)\n",
        "write import random, and random.random",
        "from random",
    ),
}  # fmt: skip
# What made the value is not seen here, so it is not said.
OTHERS = {
    "given from outside": ("def text(self):", "def text(self, words=None):\n        words[0]"),
    "one of two": ("now = time.time()", "now = self.get(1) + self.get(2)"),
}


def run(file: Path) -> str:
    """Run a file as a student does, and return what it prints."""
    return printed_by("-I", file, typed="0\n")


@pytest.mark.parametrize(("right", "wrong"), TYPED.values(), ids=TYPED)
def test_the_fix_is_typed_as_it_is_told(tmp_path: Path, right: str, wrong: str) -> None:
    assert "Traceback" not in run(written(tmp_path, ROBOT))
    file = written(tmp_path, ROBOT.replace(right, wrong))
    text = run(file)
    error = text.splitlines()[-1]
    (found,) = of_text(text)
    assert found.code == "made-wrong", text
    lines = file.read_text().splitlines()
    number = int(found.place.rpartition(":")[2]) - 1
    line = re.sub(r" there; .*", "", found.fix.removeprefix("write "))
    if (
        number == next(n for n, each in enumerate(lines) if each.endswith(wrong.splitlines()[-1]))
        and "=" not in line
    ):
        line = f"{lines[number].strip().partition('=')[0]}= {line}" if "=" in lines[number] else line
    lines[number] = re.match(r" *", lines[number])[0] + line  # type: ignore[index]
    assert error not in run(written(tmp_path, "\n".join(lines)))


@pytest.mark.parametrize(("right", "wrong", "fix", "place"), TOLD.values(), ids=TOLD)
def test_the_line_that_made_it_is_told(tmp_path: Path, right: str, wrong: str, fix: str, place: str) -> None:
    file = written(tmp_path, ROBOT.replace(right, wrong))
    (found,) = of_text(run(file))
    assert found.code == "made-wrong"
    assert fix in found.fix
    line = int(found.place.rpartition(":")[2])
    assert place in file.read_text().splitlines(keepends=True)[line - 1]


@pytest.mark.parametrize(("right", "wrong"), OTHERS.values(), ids=OTHERS)
def test_what_is_not_seen_is_not_said(tmp_path: Path, right: str, wrong: str) -> None:
    found = of_text(run(written(tmp_path, ROBOT.replace(right, wrong))))
    assert [one.code for one in found] != ["made-wrong"]


def written(folder: Path, text: str) -> Path:
    file = folder / "robot.py"
    file.write_text(text)
    return file


def test_a_message_that_is_given_whole(tmp_path: Path) -> None:
    """The function that fails is right; who calls it gives it too much."""
    (tmp_path / "words.py").write_text("def plain(word):\n    return word.strip().lower()\n")
    text = (
        f'Traceback (most recent call last):\n  File "{tmp_path}/robot.py", line 3, in <module>\n    print(plain(msg))\n'
        f'  File "{tmp_path}/words.py", line 2, in plain\n    return word.strip().lower()\n'
        "AttributeError: 'String' object has no attribute 'strip'\n"
    )
    written(tmp_path, "from std_msgs.msg import String\nmsg = String()\nprint(plain(msg))\n")
    (found,) = of_text(text)
    assert found.place.endswith("robot.py:3")
    assert found.fix == "write plain(msg.data)"
