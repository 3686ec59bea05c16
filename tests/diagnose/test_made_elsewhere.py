"""What an error's line only uses: the part of a service, the clock of a time, and the line of a data file."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text
from ros2lab.diagnose.finding import Finding

PROGRAM = """\
from rclpy.clock import Clock
from rclpy.duration import Duration
from rclpy.time import Time
from std_srvs.srv import SetBool, Trigger


class Hut:
    def get_clock(self):
        return ROS

    def __init__(self):
        BEGIN

    def step(self, request=None, response=None):
        LINES


from rclpy.clock import ClockType  # noqa: E402

ROS = Clock(clock_type=ClockType.ROS_TIME)
Hut().step()
"""
WRONG = {
    "a request": ("pass", "req = SetBool()\n        req.data = True", "SetBool.Request()"),
    "a request that nothing is put into": ("pass", "req = Trigger()", "Trigger.Request()"),
    "a request of the object": ("self.req = SetBool()\n        self.req.data = False", "pass", "SetBool.Request()"),
    "a request with its field": ("pass", "req = SetBool(data=True)", "SetBool.Request(data=True)"),
    "an answer": ("pass", "answer = SetBool()\n        answer.success = True\n        return answer", "SetBool.Response()"),
    "an answer that is only given back": ("pass", "return Trigger()", "Trigger.Response()"),
    "a time of the object": ("self.last = Time()", "gap = self.get_clock().now() - self.last", "Time(clock_type=self.get_clock().clock_type)"),
    "a time with a value": ("self.last = Time(seconds=3)", "late = self.last < self.get_clock().now()", "Time(seconds=3, clock_type=self.get_clock().clock_type)"),
    "a time of the function": ("pass", "last = Time()\n        gap = self.get_clock().now() - last", "Time(clock_type=self.get_clock().clock_type)"),
    "a time in the line": ("pass", "gap = self.get_clock().now() - Time()", "Time(clock_type=self.get_clock().clock_type)"),
    "a clock of its own": ("self.clock = 0\n        self.last = Clock().now()", "gap = self.get_clock().now() - self.last", "self.get_clock()"),
}  # fmt: skip


def said_by(root: Path, text: str) -> str:
    """Write the program into a workspace, and return what it prints."""
    files = Files.right(NAMES[1])
    files.put("PACKAGE/hut.py", text).write(root)
    command = [sys.executable, root / files.path("PACKAGE/hut.py")]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    return ran.stdout + ran.stderr


@pytest.mark.parametrize("name", WRONG)
def test_what_is_made_otherwise_than_meant(name: str, tmp_path: Path) -> None:
    begin, lines, new = WRONG[name]
    text = PROGRAM.replace("BEGIN", begin).replace("LINES", lines)
    first = of_text(said_by(tmp_path, text), tmp_path)[0]
    assert first.code == "made-wrong"
    assert first.fix.startswith(f"write {new} instead of ")
    old = first.fix.partition(" instead of ")[2]
    assert said_by(tmp_path, text.replace(old, new)) == ""


def test_another_error_of_a_line_with_a_part_is_none_of_it(tmp_path: Path) -> None:
    text = PROGRAM.replace("BEGIN", "pass").replace("LINES", "req = SetBool.Request(data=1 + 'a')")
    assert all("whole service" not in one.cause for one in of_text(said_by(tmp_path, text), tmp_path))


RIGHT = """{
  "museum": "Old",
  "is_open": true,
  "rooms": [
    {"name": "Egypt", "seconds": 1.5},
    {"name": "Rome", "seconds": 0.5}
  ],
  "guide": null
}
"""
READER = "import json\nfrom pathlib import Path\n\njson.loads((Path(__file__).parent.parent / 'config' / 'rooms.json').read_text())\n"
FAULTY = {
    "a comma after the last element": ('"seconds": 0.5}\n', '"seconds": 0.5},\n', 6),
    "a comma after the last member": ('"guide": null', '"guide": null,', 8),
    "a comma too few between elements": ("1.5},", "1.5}", 5),
    "a comma too few between members": ('"Old",', '"Old"', 2),
    "single quotes": ('"Rome"', "'Rome'", 6),
    "a name without quotes": ('"guide"', "guide", 8),
    "True of Python": ("true", "True", 3),
    "None of Python": ("null", "None", 8),
    "a comment": ('"Old",', '"Old", // since 1901', 2),
    "a colon too few": ('"is_open": true', '"is_open" true', 3),
    "a number without its 0": ("0.5", ".5", 6),
}


def read_with(root: Path, text: str) -> Finding:
    files = Files.right(NAMES[1])
    files.put("config/rooms.json", text)
    said = said_by(root, READER) if files.write(root) else ""
    return of_text(said, root)[0]


@pytest.mark.parametrize("name", FAULTY)
def test_the_line_of_a_data_file_is_told(name: str, tmp_path: Path) -> None:
    right, wrong, line = FAULTY[name]
    text = RIGHT.replace(right, wrong, 1)
    first = read_with(tmp_path, text)
    assert first.place == f"src/my_bot/config/rooms.json:{line}"
    written = first.fix.removeprefix("write `").removesuffix("`, and build again")
    lines = text.splitlines()
    lines[line - 1] = written
    assert json.loads("\n".join(lines)) == json.loads(RIGHT)


def test_a_data_file_beyond_repair_is_named(tmp_path: Path) -> None:
    first = read_with(tmp_path, RIGHT.replace('"Rome", ', '"Rome ', 1))
    assert first.place.startswith("src/my_bot/config/rooms.json:6")
