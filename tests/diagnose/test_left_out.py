"""A value that was left out, so that those after it have slid: it is put in, and none of them is exchanged."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text
from ros2lab.diagnose.sources.calls import meant_call
from ros2lab.diagnose.sources.python_source import PythonSource

CLASS = "from rclpy.node import Node\nfrom std_msgs.msg import String\nfrom std_srvs.srv import Trigger\n\n\nclass A(Node):\n    def heard(self, msg):\n        pass\n\n    def __init__(self):\n        super().__init__('a')\n"
LEFT_OUT = {
    "self.declare_parameters([('a', 1), ('b', 2.0)])": "self.declare_parameters('', [('a', 1), ('b', 2.0)])",
    "self.declare_parameters(parameters=[('a', 1)])": "self.declare_parameters('', parameters=[('a', 1)])",
    "self.create_publisher(String, 10)": "self.create_publisher(String, 'topic', 10)",
    "self.create_subscription(String, self.heard, 10)": "self.create_subscription(String, 'topic', self.heard, 10)",
    "self.create_timer(self.heard)": "self.create_timer(1.0, self.heard)",
    "self.create_service(Trigger, self.heard)": "self.create_service(Trigger, 'srv_name', self.heard)",
}
RIGHT = [
    *LEFT_OUT.values(),
    "self.create_client(Trigger, 'reset')",
    "self.create_publisher(String, 'a', qos_profile=10)",
]


def meant(line: str) -> str:
    source = PythonSource("a", "a.py", f"{CLASS}        {line}\n")
    last = source.text.count("\n")
    return meant_call(source, next(n for n in source.nodes if isinstance(n, ast.Call) and n.lineno == last))


@pytest.mark.parametrize(("line", "whole"), LEFT_OUT.items())
def test_what_was_left_out_is_put_in(line: str, whole: str) -> None:
    assert meant(line) == f"write `{whole}`"


@pytest.mark.parametrize("line", RIGHT)
def test_a_whole_call_stays(line: str) -> None:
    assert meant(line) == ""


def test_the_error_of_a_list_without_its_namespace(tmp_path: Path) -> None:
    files = Files.right(NAMES[1])
    files.change(
        "node",
        "self.declare_parameter('period', 2.0)",
        "self.declare_parameters([('period', 2.0), ('name', 'a')])",
    )
    root = files.write(tmp_path)
    file = root / "src/my_bot/my_bot/talker.py"
    number = next(
        n for n, line in enumerate(file.read_text().splitlines(), 1) if "declare_parameters" in line
    )
    text = (
        f'Traceback (most recent call last):\n  File "{file}", line {number}, in __init__\n    self.declare_parameters([('
        "'period', 2.0), ('name', 'a')])\nTypeError: Node.declare_parameters() missing 1 required positional argument: 'parameters'\n"
    )
    first = of_text(text, root)[0]
    assert first.fix == "write `self.declare_parameters('', [('period', 2.0), ('name', 'a')])`"
