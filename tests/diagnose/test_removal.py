"""What is to be removed leaves a file that Python can still read, and no loop that waits for nothing."""

from __future__ import annotations

import ast
import re
import textwrap
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose.look import Look

NODE = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.value = None
        self.create_subscription(String, 'topic', self.on_word, 10)
        self.create_timer(1.0, self.tick)

    def on_word(self, msg):
        self.value = msg.data

    def tick(self):
{lines}
        self.get_logger().info(f'{{self.value}}')


def main():
    rclpy.init()
    rclpy.spin(Talker())
"""


def applied(text: str, fix: str) -> str:
    """Apply a fix that removes something literally."""
    match = re.search(
        r"(?P<pass>write `pass` instead of|remove) (?P<loop>the whole loop )?`(?P<old>[^`]+)`", fix
    )
    assert match, fix
    rows, new = text.splitlines(), "pass" if match["pass"] != "remove" else ""
    first = next(n for n, row in enumerate(rows) if row.strip() == match["old"])
    depth = len(rows[first]) - len(rows[first].lstrip())
    last = first + 1
    while match["loop"] and len(rows[last]) - len(rows[last].lstrip()) > depth:
        last += 1
    return "\n".join([*rows[:first], *[" " * depth + new] * bool(new), *rows[last:]])


@pytest.mark.parametrize(
    "lines",
    [
        "rclpy.spin_once(self)",
        "if self.value is None:\n    rclpy.spin_once(self)",
        "if self.value:\n    print(self.value)\nelse:\n    rclpy.spin_once(self)",
        "try:\n    rclpy.spin_once(self)\nexcept RuntimeError:\n    self.value = ''",
        "for _ in range(10):\n    rclpy.spin_once(self)",
        "for _ in range(10):\n    print(self.value)\n    rclpy.spin_once(self)",
        "if self.value is None:\n    for _ in range(10):\n        rclpy.spin_once(self)",
        "while rclpy.ok():\n    rclpy.spin_once(self)",
        "with open('log') as log:\n    rclpy.spin_once(self)",
        "if self.value is None:\n    rclpy.spin(self)",
    ],
)
def test_a_spin_in_a_callback_is_removed(tmp_path: Path, lines: str) -> None:
    text = NODE.format(lines=textwrap.indent(lines, " " * 8))
    files = Files.right(NAMES[1]).put("node", text)
    codes = ("callback-waits", "spin-inside")
    (found,) = (f for f in Look(files.write(tmp_path / "a")).findings if f.code in codes)
    after = applied(text, found.fix)
    assert "spin" not in ast.unparse(ast.parse(after).body[3])
    left = Look(files.put("node", after).write(tmp_path / "b")).findings
    assert not [finding for finding in left if finding.code in ("endless-loop", "node-syntax", *codes)]


@pytest.mark.parametrize("inner", ["rclpy.spin_once(self)", "rclpy.spin_once(self, timeout_sec=0.1)", "pass"])
@pytest.mark.parametrize("before", ["", "    print('waiting')\n"])
def test_a_loop_that_waits_for_another_callback_is_moved_there(
    tmp_path: Path, inner: str, before: str
) -> None:
    lines = textwrap.indent(f"while self.value is None:\n{before}    {inner}", " " * 8)
    files = Files.right(NAMES[1]).put("node", NODE.format(lines=lines))
    (found,) = (f for f in Look(files.write(tmp_path)).findings if f.code == "callback-waits")
    assert found.fix == "do the work that needs self.value in on_word(), once it has been set"


def test_an_empty_endless_loop_has_no_body_to_run(tmp_path: Path) -> None:
    text = NODE.format(lines="        if self.value == 'end':\n            while True:\n                pass")
    files = Files.right(NAMES[1]).put("node", text)
    (found,) = (f for f in Look(files.write(tmp_path)).findings if f.code == "endless-loop")
    assert found.fix == "write `pass` instead of the loop"


def test_the_only_line_of_a_block_without_effect(tmp_path: Path) -> None:
    text = NODE.format(lines="        if self.value:\n            self.value + 1")
    files = Files.right(NAMES[1]).put("node", text)
    (found,) = (f for f in Look(files.write(tmp_path)).findings if f.code == "no-effect")
    assert found.fix == "assign it to a variable, or write `pass` instead of the line"
