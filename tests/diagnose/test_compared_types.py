"""Comparisons with a value of another type than the other side has, as the type checker tells it."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.finding import Finding


def told(condition: str, root: Path) -> list[Finding]:
    files = right_workspace().change("listener", "msg.data == 'start'", condition)
    return [one for one in of_workspace(files.write(root)) if one.code == "never-equal"]


@pytest.mark.parametrize(
    ("condition", "fix"),
    [
        ("msg.data.split(' ') == 'start'", "write `'start' in msg.data.split(' ')`"),
        ("msg.data.split() != 'start'", "write `'start' not in msg.data.split()`"),
        ("msg.data.encode() == 'start'", "write `msg.data.encode() == b'start'`"),
        ("self.get_name == 'robot'", "write self.get_name()"),
        ("len(msg.data) == '3'", "write `len(msg.data) == 3`"),
        ("msg.data.find('start') == 'start'", "write `str(msg.data.find('start')) == 'start'`"),
        ("msg.data[0] == 1", "write `msg.data[0] == '1'`"),
        ("1 == msg.data.split(',')[0]", "write `msg.data.split(',')[0] == '1'`"),
        ("self.declare_parameter('mode', 'slow') == 'fast'", ".value instead of"),
        ("self.get_clock().now() == '12:00'", "compare what is a string on both sides"),
        ("msg.data.partition(' ') == 'start'", "write `'start' in msg.data.partition(' ')`"),
        ("float(msg.data) in ('1', '2')", "compare what is a string on both sides"),
        ("msg.data == 'a' or msg.data.split() == 'b' and len(msg.data) == '3'", "write `'b' in msg.data.split()`"),
    ],
)  # fmt: skip
def test_it_is_told_with_what_to_write(tmp_path: Path, condition: str, fix: str) -> None:
    found = told(condition, tmp_path)
    assert found, condition
    assert fix in found[0].fix


@pytest.mark.parametrize(
    "condition",
    [
        "msg.data.split(' ')[0] == 'start'",
        "msg.data.split(' ') == ['start']",
        "msg.data.strip() == 'start'",
        "len(msg.data) == 3.0",
        "len(msg.data) == True",
        "float(msg.data) == 1",
        "msg.data[0] in ('s', 't')",
        "msg.data[:2] in ('st', 1)",
        "self.declare_parameter('mode', 'slow').value == 'fast'",
        "getattr(self, 'mode', None) == 'fast'",
        "self.state == 'running'",
        "(msg.data or None) == 'start'",
        "msg.data.encode() == b'start'",
        "msg.data.isdigit() == True",
        "self.count_publishers('/robot/report') == 0",
    ],
)
def test_what_may_be_equal_is_left_alone(tmp_path: Path, condition: str) -> None:
    assert told(condition, tmp_path) == []
