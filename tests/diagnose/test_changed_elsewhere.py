"""What a class changes in another way than by an assignment, and what stands for another thing than it seems to."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

CALLBACK = "        self.count += 1\n"
SET = "\ndef put_back(self):\n    self.kept = self.first\n"
SENT = (
    "\ndef hear(self, msg):\n    temp = String()\n    BIND\n    temp.data = 'a'\n    self.pub.publish(msg)\n"
)
HEAR = "self.create_subscription(String, 'heard', self.hear, 10)"


def told(root: Path, in_init: str, in_callback: str, in_class: str) -> list[str]:
    files = Files.right(NAMES[1]).change(
        "node", "import rclpy\n", "import copy\nimport enum\n\nimport numpy as np\nimport rclpy\n"
    )
    files.change("node", "        self.count = 0\n", textwrap.indent(f"self.count = 0\n{in_init}\n", " " * 8))
    files.change(
        "node",
        CALLBACK,
        CALLBACK + textwrap.indent(in_callback, " " * 8) + "\n" + textwrap.indent(in_class, "    "),
    )
    codes = [finding.code for finding in of_workspace(files.write(root))]
    return [code for code in codes if "dependency" not in code]


@pytest.mark.parametrize(
    ("change", "is_told"),
    [
        ("self.kept[0] = 1", False),
        ("self.kept[:] = [1]", False),
        ("self.kept += [1]", False),
        ("self.kept.append(1)", False),
        ("np.copyto(self.kept, [1])", False),
        ("del self.kept[0]", False),
        ("self.get_logger().info(str(self.kept))", True),
        ("first = self.kept[0]\nprint(first)", True),
    ],
)
def test_a_part_that_is_set_is_a_change(tmp_path: Path, change: str, is_told: bool) -> None:
    read = "self.get_logger().info(f'{self.kept}')"
    found = told(tmp_path, "self.kept = [0]\nself.first = [2]", f"{change}\n{read}", SET)
    assert found == ["never-called"] * is_told


@pytest.mark.parametrize(
    ("lines", "is_told"),
    [
        ("self.least = 1\nself.least += 1", True),
        ("self.least = 1\nfor one in range(3):\n    if one < self.least:\n        self.least = one\nself.least *= 10.0", False),
        ("self.least = 0\nfor one in range(3):\n    self.least += one", False),
        ("self.least = 0\nself.put_back()\nself.least += 1", False),
    ],
)  # fmt: skip
def test_what_is_set_to_more_than_a_beginning_is_no_count(tmp_path: Path, lines: str, is_told: bool) -> None:
    found = told(
        tmp_path, "self.least = 0", lines, "\ndef put_back(self):\n    self.least = 3\n" * ("put" in lines)
    )
    assert found == ["begun-anew"] * is_told


@pytest.mark.parametrize(
    ("bind", "is_told"),
    [
        ("pass", True),
        ("temp = copy.deepcopy(msg)", True),
        ("temp = msg", False),
        ("temp: String = msg", False),
        ("temp, other = msg, 1\n    print(other)", False),
        ("temp = self.count or msg", False),
    ],
)
def test_a_second_name_of_a_message_fills_what_is_sent(tmp_path: Path, bind: str, is_told: bool) -> None:
    found = told(tmp_path, HEAR, "", SENT.replace("BIND", bind))
    assert ("never-sent" in found) == is_told


@pytest.mark.parametrize(
    ("after", "is_told"),
    [("'a note'", False), ("...", False), ("'a note'\n    pass", False), ("'a note'\n    print(self)", True), ("yield", False)],
)  # fmt: skip
def test_a_note_below_a_return_is_not_missed(tmp_path: Path, after: str, is_told: bool) -> None:
    found = told(tmp_path, "", "print(self.done())", f"\ndef done(self):\n    return 1\n    {after}\n")
    assert found == ["unreachable"] * is_told


@pytest.mark.parametrize(
    ("body", "used", "is_told"),
    [
        ("class Beat:\n    up = 0", "self.Beat()", False),
        ("class Kind(enum.Enum):\n    IDLE = 1", "self.Kind.IDLE", False),
        ("if True:\n    class Beat:\n        up = 0", "self.Beat()", False),
        ("class Beat:\n    up = 0", "self.Beta()", True),
    ],
)
def test_a_class_inside_a_class_is_an_attribute(tmp_path: Path, body: str, used: str, is_told: bool) -> None:
    assert told(tmp_path, "", f"print({used})", f"\n{body}\n") == ["attribute-missing"] * is_told
