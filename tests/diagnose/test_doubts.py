"""Right code that a type checker rejects, because Python itself does not check types; and what does fail."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

TALK = "        self.count += 1\n"
TOP = """\
import signal
from dataclasses import dataclass

import msvcrt
import numpy as np
from PIL import Image
from rclpy.qos import QoSHistoryPolicy, QoSReliabilityPolicy
from std_msgs.msg import Header


@dataclass
class Size:
    wide: int


def scaled(value: int, by: int = 2):
    return value * by


"""
RIGHT = """\

def split(self, text: str):
    text = text.split()
    return text == 3 or text.append('x')

def padded(self, number: int):
    number = f'{number:03d}'
    return number.upper() + 'x'

def widened(self):
    self.width: int = 3
    self.width = str(self.width)
    return self.width.upper()

def halved(self, given: float):
    return scaled(given, by=given), Size(given)

def asked(self, thing: String):
    if isinstance(thing, Header):
        return thing.stamp
    return thing.header if hasattr(thing, 'header') else thing.data

def matched(self, thing: String):
    match thing:
        case Header():
            return thing.frame_id

def handled(self):
    old = signal.signal(signal.SIGINT, signal.SIG_DFL)
    if old is not None:
        old(signal.SIGINT, None)

def told(self, grid: list[list[int]], i: int):
    return isinstance(grid[i][0], str) and grid[i][0] == '*'

def skipped(self, grid: list[list[int]], i: int):
    if not isinstance(grid[i], list) or type(grid[i][i]) is int:
        return None
    return grid[i][i] == '*'

def level(self) -> int:
    return 3

def leveled(self):
    return isinstance(self.level(), str) and self.level() == 'high'

def marked(self, grid: list[list[int]], i: int):
    grid[i][0] = '*'
    return grid[0][i] == '*'

def resized(self, sizes: list[Size], i: int, j: int):
    sizes[i].wide = 'big'
    return sizes[j].wide == 'big'

def named(self, known: dict[str, int], name: str):
    known[name] = 'x'
    return known['a'] == 'x'

def counted(call):
    def wrapper(self):
        self.get_logger().info(call.__name__)
        return call(self)
    return wrapper

def trusted(self):
    kept = QoSHistoryPolicy.RMW_QOS_POLICY_HISTORY_KEEP_LAST
    return kept, QoSHistoryPolicy.KEEP_ALL, QoSReliabilityPolicy.RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT

def pressed(self):
    return msvcrt.getch(), msvcrt.kbhit

@counted
def smaller(self):
    return Image.new('L', (9, 9)).resize((3, 3), Image.BILINEAR), np.float_(3), np.trapz([1.0])
"""


def told(code: str, root: Path, top: str = "") -> list[str]:
    files = Files.right(NAMES[1]).change("node", TALK, TALK + textwrap.indent(code, "    "))
    files.change("node", "class CLASS", f"{top}class CLASS")
    return [finding.code for finding in of_workspace(files.write(root)) if "dependency" not in finding.code]


def test_what_runs_in_spite_of_its_annotations_is_no_alarm(tmp_path: Path) -> None:
    assert told(RIGHT, tmp_path, TOP) == []


@pytest.mark.parametrize(
    ("code", "body"),
    [
        ("never-equal", "def told(self, text: str):\n    return text == 3"),
        ("never-equal", "def told(self, grid: list[list[int]], i: int):\n    return isinstance(i, int) and grid[i][0] == '*'"),
        ("never-equal", "def told(self, grid: list[list[int]], i: int):\n    grid[i][0] = 1\n    return grid[i][0] == '*'"),
        ("never-equal", "def told(self, number: int):\n    return not isinstance(number, str) and number == '*'"),
        ("argument-type", "def told(self):\n    return scaled('3')\n\n\ndef more(value: int):\n    return value + 1"),
        ("argument-type", "def rows(self, number: int):\n    return list(range(number))\n\ndef told(self, given: float):\n    return self.rows(given)"),
        ("message-field", "def told(self, thing: String):\n    return thing.header"),
        ("not-callable", "def told(self):\n    number = 3\n    return number(2)"),
        ("attribute-missing", "def told(self):\n    return signal.signl"),
        ("attribute-missing", "def told(self):\n    return QoSReliabilityPolicy.RMW_QOS_POLICY_RELIABILITY_BEST"),
        ("attribute-missing", "def told(self):\n    return QoSReliabilityPolicy.BEST_EFORT"),
    ],
)  # fmt: skip
def test_what_fails_is_told(tmp_path: Path, code: str, body: str) -> None:
    top = "import signal\n\nfrom rclpy.qos import QoSReliabilityPolicy\n\n\ndef scaled(value: int):\n    return value + 1\n\n\n"
    assert told(f"\n{body}\n", tmp_path, top) == [code]
