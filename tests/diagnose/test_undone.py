"""What a callback undoes itself is told from what was noted; what is reset on purpose is not."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.trial.undone import undone_faults
from ros2lab.trial.witnessed import environ_in, witnessed

NAME = NAMES[0]
ROBOT = """\
import enum
from collections import deque

mode = 'shut'


class Gear(enum.Enum):
    LOW = 1
    HIGH = 2


class Odd:
    def __eq__(self, other):
        raise ValueError('the truth of an array')


class Closing:
    open = 0

    def __init__(self):
        Closing.open += 1

    def __del__(self):
        Closing.open -= 1


class Robot:
    def __init__(self):
        self.state = 'idle'
        self.lamp = False
        self.gear = Gear.LOW
        self.parts = {'door': 'shut'}
        self.every = 1
        self.count = 0
        self.window = []
        self.queue = deque()
        self.pose = {'x': 0}
        self.sent = []
        self.callbacks = [self.on_press, self.on_tick]

    def publish(self, value):
        self.sent.append(str(value))

    def show(self):
        self.publish(self.state)

    def go(self, state):
        self.state = state

    def open(self):
        if self.state == 'idle':
            self.state = 'open'

    def shut(self):
        if self.state == 'open':
            self.state = 'idle'

    def wave(self):
        if self.state == 'open':
            self.show()
            self.state = 'idle'

    def keep(self, number):
        self.window.append(number)

    def turn(self):
        self.lamp = not self.lamp

    def on_tick(self):
        TICK

    def on_press(self, number):
        BODY
"""
DRIVE = "robot = Robot()\nfor number in range(12):\n    robot.on_press(number + 0.5)\n    robot.on_tick()\n"
FIRST = ROBOT[: ROBOT.index("BODY")].count("\n") + 1


def undone(body: str, folder: Path, tick: str = "pass") -> list[Finding]:
    """Return what is found in a robot whose callbacks a program calls."""
    code = ROBOT.replace("BODY", textwrap.indent(body, " " * 8).strip()).replace("TICK", tick)
    files = Files.right(NAME)
    root = files.put("node", code).write(folder / "ws")
    notes = folder / "notes"
    notes.mkdir()
    environ = {**os.environ, **environ_in(notes, root, {})}
    drive = f"from {NAME.package}.{Path(files.path('node')).stem} import Robot\n{DRIVE}"
    home = root / "src" / NAME.package
    done = subprocess.run(
        [sys.executable, "-c", drive], cwd=home, env=environ, capture_output=True, text=True, check=False
    )
    assert done.stderr == ""
    return [*undone_faults(witnessed(notes, Look(root)).unreached.record)]


def rows(*lines: str) -> str:
    """Return lines in one text."""
    return "\n".join(lines)


CHAIN = rows(
    "if self.state == 'idle':",
    "    self.state = 'busy'",
    "if self.state == 'busy':",
    "    self.state = 'idle'",
)


@pytest.mark.parametrize(
    ("body", "said", "fix", "line"),
    [
        (CHAIN, f"In 12 calls of on_press(), self.state went from 'idle' to 'busy' (line {FIRST + 1}) and 'idle' (line {FIRST + 3})", f"write `elif` instead of `if` on line {FIRST + 2}", 2),
        (rows("if self.state == 'idle': self.go('up')", "if self.state == 'up': self.go('down')", "if self.state == 'down': self.go('idle')"), "to 'up'", f"on lines {FIRST + 1} and {FIRST + 2}", 1),
        (rows("if not self.lamp:", "    self.lamp = True", "    self.publish('on')", "if self.lamp:", "    self.lamp = False", "    self.publish('off')"), "self.lamp went from False to True", "write `elif`", 3),
        (rows("if self.gear is Gear.LOW:", "    self.gear = Gear.HIGH", "print(number)", "if self.gear is Gear.HIGH:", "    self.gear = Gear.LOW"), "from Gear.LOW to Gear.HIGH", "let only one of these tests hold", 3),
        (rows("self.open()", "self.shut()"), "self.state went from 'idle' to 'open'", "let only one of these tests hold", None),
        (rows("if self.count == 0: self.count += 1", "if self.count == 1: self.count += 1", "if self.count == 2: self.count = 0"), "self.count went from 0 to 1", "write `elif`", 1),
        (rows("self.keep(number)", "if len(self.window) > 3: self.window.pop()"), "it kept the same 3 items", "write `self.window.pop(0)`", 1),
        # What it got may be what it holds already.
        (rows("self.window.append(number % 5)", "if len(self.window) > 3: self.window.pop()"), "it kept the same 3 items", "write `self.window.pop(0)`", 1),
        (rows("global mode", "if mode == 'shut': mode = 'open'", "if mode == 'open': mode = 'shut'"), "mode went from 'shut' to 'open'", "write `elif`", 2),
        (rows("if self.parts['door'] == 'shut': self.parts['door'] = 'open'", "if self.parts['door'] == 'open': self.parts['door'] = 'shut'"), "self.parts['door'] went from 'shut'", "write `elif`", 1),
        (rows("self.lamp = not self.lamp", "self.turn()"), "it is reversed twice", "reverse self.lamp once", 1),
        (rows("self.window.append(number)", "if len(self.window) > 3:", "    self.window.pop()"), "it kept the same 3 items", "write `self.window.pop(0)`", 2),
        (rows("self.queue.append(number)", "while len(self.queue) > 3: self.queue.pop()"), "it kept the same 3 items", "`self.queue.popleft()`", 1),
        (rows("self.queue.appendleft(number)", "if len(self.queue) > 3: self.queue.popleft()"), "it kept the same 3 items", "write `self.queue.pop()`", 1),
        (rows("self.window.insert(0, number)", "self.publish(max(self.window))", "if len(self.window) > 3: del self.window[0]"), "it kept the same 3 items", "write `del self.window[-1]`", 2),
        (rows("self.window.append(number)", "self.window = self.window[:3]"), "it kept the same 3 items", "write `self.window = self.window[-3:]`", 1),
        (rows("self.pose['x'] = number", "self.window.append(self.pose)"), "holds one and the same dict 12 times", "copy.deepcopy(self.pose)", 1),
    ],
)  # fmt: skip
def test_what_undoes_itself_is_told(tmp_path: Path, body: str, said: str, fix: str, line: int | None) -> None:
    (found,) = undone(body, tmp_path)
    assert said in found.cause
    assert fix in found.fix
    assert line is None or found.place.endswith(f":{FIRST + line}")


@pytest.mark.parametrize(
    ("body", "tick"),
    [
        (CHAIN.replace("if self.state == 'busy'", "elif self.state == 'busy'"), "pass"),
        (rows("self.state = 'busy'", "self.publish(number)", "self.state = 'idle'"), "pass"),
        (rows("old = self.state", "self.state = 'busy'", "try: self.show()", "finally: self.state = old"), "pass"),
        (rows("self.count += 1", "if self.count >= self.every: self.count = 0"), "pass"),
        (rows("if self.count < 1: self.count += 1", "if self.count >= self.every: self.count = 0"), "pass"),
        (rows("if self.state == 'idle': self.state = 'busy'", "if self.state == 'busy':", "    self.show()", "    self.state = 'idle'"), "pass"),
        (rows("if self.lamp: self.lamp = False", "if number < 99: self.lamp = True"), "pass"),
        (rows("if self.lamp: self.lamp = False", "if not self.lamp and number > 0: self.lamp = True"), "pass"),
        (rows("if not self.lamp: self.lamp = True", "if number < 99: return", "if self.lamp: self.lamp = False"), "self.lamp = False"),
        (rows("self.open()", "self.show()", "self.shut()"), "pass"),
        (rows("self.open()", "self.wave()"), "pass"),
        (rows("self.turn()", "self.publish(self.lamp)", "self.turn()"), "pass"),
        (CHAIN, "self.state = 'busy' if self.state == 'idle' and self.sent else self.state\n        self.publish(1)"),
        (rows("self.queue.appendleft(number)", "if len(self.queue) > 3: self.queue.pop()"), "pass"),
        (rows("self.window.append(number)", "self.publish(self.window[-1])", "self.window.pop()"), "pass"),
        (rows("self.window.append(number)", "if len(self.window) > 3: self.window.pop()"), "self.window and self.window.pop(0)"),
        (rows("self.window.append(number)", "if len(self.window) > 3: self.window.pop()"), "if self.count > 99: self.window.pop(0)"),
        (rows("self.count += 1", "self.window.append(self)"), "pass"),
        (rows("self.window.append(number)", "self.window.sort()", "if len(self.window) > 3: self.window.pop()"), "pass"),
        (rows("self.window.append(7)", "if len(self.window) > 3: self.window.pop(0)"), "pass"),
        (rows("self.window.append({'x': number})"), "pass"),
        (rows("self.window.append(self.pose)"), "pass"),
        (rows("self.pose['x'] = number", "self.window.append(self.pose)", "self.window.clear()"), "pass"),
        # The program is not disturbed by what is noted.
        (rows("self.count = (self.count + 2) ** 2"), "pass"),
        (rows("self.window.append(Odd())", "self.window.append(None)", "if number < 9: self.window.pop()"), "pass"),
        (rows("self.window.append(Closing())", "self.window.pop()", "assert Closing.open == 0"), "pass"),
    ],
)  # fmt: skip
def test_what_is_meant_is_not_told(tmp_path: Path, body: str, tick: str) -> None:
    assert undone(body, tmp_path, tick) == []


def test_what_is_set_very_often_is_noted_only_at_first(tmp_path: Path) -> None:
    body = rows("for self.count in range(3000):", "    self.state = 'idle'", CHAIN)
    assert [one.code for one in undone(body, tmp_path)] == []
