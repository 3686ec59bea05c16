"""Conflicts that git leaves in a file: one of two versions is to be kept, not both."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.code.merge_conflicts import conflict_in

OPEN, BASE, MIDDLE, CLOSE = "<<<<<<< HEAD\n", "||||||| 1a2b3c\n", "=======\n", ">>>>>>> jonas/names\n"
MARKS = "and delete the other and the marks on lines"
TWO = f"{OPEN}a\n{MIDDLE}b\n{CLOSE}"


@pytest.mark.parametrize(
    ("text", "line", "told"),
    [
        (f"x\n{TWO}", 2, f"keep line 3 (HEAD) or line 5 (jonas/names), or what you need of both, {MARKS} 2, 4 and 6"),
        (f"{OPEN}a\nb\n{MIDDLE}c\n{CLOSE}", 1, f"keep lines 2 to 3 (HEAD) or line 5 (jonas/names), or what you need of both, {MARKS} 1, 4 and 6"),
        (f"{OPEN}a\n{BASE}o\n{MIDDLE}b\n{CLOSE}", 1, "keep line 2 (HEAD) or line 6 (jonas/names), or what you need of both, and delete the other, what was there before (line 4) and the marks on lines 1, 3, 5 and 7"),
        (f"{OPEN}{MIDDLE}b\n{CLOSE}", 1, f"keep nothing (HEAD) or line 3 (jonas/names), or what you need of both, {MARKS} 1, 2 and 4"),
        (f"{TWO}x\n{TWO}", 1, f"keep line 2 (HEAD) or line 4 (jonas/names), or what you need of both, {MARKS} 1, 3 and 5; likewise from line 7 on"),
    ],
)  # fmt: skip
def test_what_to_keep(text: str, line: int, told: str) -> None:
    found = conflict_in(text)
    assert found is not None
    assert (found.line, found.told) == (line, told)


@pytest.mark.parametrize(
    "text", ["", OPEN, f"Title\n{MIDDLE}", f"{MIDDLE}{CLOSE}", f"  {OPEN}  {MIDDLE}  {CLOSE}"]
)
def test_single_marks_are_none(text: str) -> None:
    assert conflict_in(text) is None


@pytest.mark.parametrize(
    ("file", "code", "line"),
    [
        ("node", "node-syntax", "from std_msgs.msg import String\n"),
        ("setup.py", "setup-syntax", "package_name = 'my_bot'\n"),
        ("package.xml", "manifest-invalid", "  <license>Apache-2.0</license>\n"),
        ("launch/robot.launch.py", "launch-syntax", "from launch_ros.actions import Node\n"),
    ],
)
def test_a_conflict_in_a_file(tmp_path: Path, file: str, code: str, line: str) -> None:
    files = right_workspace().change(file, line, f"{OPEN}{line}{MIDDLE}{line}{CLOSE}")
    (found,) = (one for one in of_workspace(files.write(tmp_path)) if one.code == code)
    assert "git left a merge conflict" in found.cause
    assert found.fix.startswith("keep line ")
