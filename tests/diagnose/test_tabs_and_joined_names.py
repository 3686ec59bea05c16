"""Files indented by tabs, and names with a space in them: the fix is what Python then reads as it was meant."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from ros2lab.diagnose.code.syntax_repairs import repairs_of, syntax_finding
from ros2lab.diagnose.sources.python_source import read_source

_RIGHT = """\
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import TwistStamped


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.timer = self.create_timer(1.0, self.timer_callback)
        self.max_speed = 1.0

    def timer_callback(self):
        if self.max_speed > 0.5:
            self.get_logger().info('hello')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Talker())
"""


def told(text: str, folder: Path) -> tuple[str, str]:
    """Return what is said of a text that Python cannot read, and the text with all repairs."""
    path = folder / "talk.py"
    path.write_text(text, encoding="utf-8")
    source = read_source(path, "talk", "talk.py")
    assert not source.tree.body
    assert source.fault
    finding = syntax_finding("node-syntax", source)
    lines = text.split("\n")
    for repair in repairs_of(text, source.fault):
        lines = repair.applied(lines)
    return f"{finding.cause} {finding.fix}", "\n".join(lines)


@pytest.mark.parametrize("level", ["    ", "\t"])
@pytest.mark.parametrize(
    "head", ["def __init__(self):", "def timer_callback(self):", "if self", "def main(", "class Talker"]
)
def test_a_body_that_is_not_indented_is_moved_by_what_indents_the_file(
    tmp_path: Path, level: str, head: str
) -> None:
    right = _RIGHT.replace("    ", level)
    lines = right.split("\n")
    first = next(number for number, line in enumerate(lines) if line.strip().startswith(head))
    depth = len(lines[first]) - len(lines[first].lstrip())
    last = first + 1
    while last < len(lines) and (not lines[last] or lines[last].startswith(lines[first][:depth] + level)):
        lines[last] = lines[last].removeprefix(level)
        last += 1
    said, repaired = told("\n".join(lines), tmp_path)
    assert "must be indented further than it" in said
    assert ("tab" in said.replace("no tab", "")) is (level == "\t")
    assert ast.dump(ast.parse(repaired)) == ast.dump(ast.parse(right))


def test_a_line_of_spaces_among_tabs_gets_tabs(tmp_path: Path) -> None:
    right = _RIGHT.replace("    ", "\t")
    said, repaired = told(right.replace("\t\tself.max_speed", "        self.max_speed"), tmp_path)
    assert "begin line 10 with 2 tabs and no space" in said
    assert repaired == right


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("self.timer_callback)", "self.timer callback)"),  # of the file
        ("if self.max_speed", "if self.max speed"),
        ("def timer_callback", "def timer callback"),
        ("rclpy.spin(Talker", "rclpy.spin(Tal ker"),
        ("create_timer", "create timer"),  # of a node
        ("get_logger", "get_ logger"),
        ("TwistStamped", "Twist Stamped"),  # a message
    ],
)
def test_a_space_in_a_name_is_removed(tmp_path: Path, name: str, parts: str) -> None:
    said, repaired = told(_RIGHT.replace(name, parts), tmp_path)
    assert "there is a space in the name" in said
    assert repaired == _RIGHT


@pytest.mark.parametrize(
    ("right", "wrong", "sign"),
    [
        ("self.timer_callback)", "self timer_callback)", "a dot"),
        ("rclpy.spin(", "rclpy spin(", "a dot"),
        ("1.0, self.timer", "1.0 self.timer", "a comma"),
        ("import TwistStamped", "import TwistStamped Twist", "a comma"),
    ],
)
def test_two_names_remain_two(tmp_path: Path, right: str, wrong: str, sign: str) -> None:
    assert f"{sign} is missing" in told(_RIGHT.replace(right, wrong), tmp_path)[0]


@pytest.mark.parametrize(
    "head", ["def timer_callback(self;:", "class My Talker(Node):", "def ti me(self):", "class Talker Node:"]
)
def test_a_definition_is_no_text_without_quotes(tmp_path: Path, head: str) -> None:
    line = "    def timer_callback(self):" if head.startswith("def") else "class Talker(Node):"
    indent = line[: len(line) - len(line.lstrip())]
    assert "no quotes" not in told(_RIGHT.replace(line, f"{indent}{head}"), tmp_path)[0]
