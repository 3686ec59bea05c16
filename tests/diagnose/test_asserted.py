"""Values that a setter of rclpy refuses by a bare assertion: which one it is, and what is written instead."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from one_file import printed_by
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

NAME = NAMES[1]
NODE = f"{NAME.package}/{NAME.module}.py"
HEAD = "import datetime\n\nimport rclpy\nfrom builtin_interfaces.msg import Duration as Lasting\nfrom rclpy.qos import QoSProfile, ReliabilityPolicy\n\nKEPT = 'transient_local'\nLIMIT = 0.5\n"


def written(line: str, root: Path) -> Path:
    text = f"{HEAD}\n\ndef main():\n    {line}\n    return qos\n\n\nmain()\n"
    files = Files.right(NAME).put(NODE, text)
    return files.write(root) / "src" / NAME.package / NODE


@pytest.mark.parametrize(
    ("line", "cause", "fix"),
    [
        ("qos = QoSProfile(depth=5, reliability='best_effort')", "reliability takes a ReliabilityPolicy of rclpy.qos", "write `ReliabilityPolicy.BEST_EFFORT` instead of `'best_effort'`"),
        ("qos = QoSProfile(depth=5, durability=KEPT)", "durability takes a DurabilityPolicy", "write `DurabilityPolicy.TRANSIENT_LOCAL` instead of `KEPT`, with `from rclpy.qos import DurabilityPolicy` at the top"),
        ("qos = QoSProfile(depth=5, history='keep_last')", "history takes a HistoryPolicy", "write `HistoryPolicy.KEEP_LAST` instead of"),
        ("qos = QoSProfile(depth=5, liveliness='automatic')", "liveliness takes a LivelinessPolicy", "write `LivelinessPolicy.AUTOMATIC` instead of"),
        ("qos = QoSProfile(depth=5, reliability=ReliabilityPolicy)", "but `ReliabilityPolicy` is none", "or `ReliabilityPolicy.BEST_EFFORT` or"),
        ("qos = QoSProfile(\n        depth=5,\n        deadline=1.0,\n    )", "deadline takes a Duration of rclpy.duration", "write `Duration(seconds=1.0)` instead of `1.0`, with `from rclpy.duration import Duration` at the top"),
        ("qos = QoSProfile(depth=5, lifespan=LIMIT)", "lifespan takes a Duration", "write `Duration(seconds=LIMIT)` instead"),
        ("qos = QoSProfile(depth=5, lifespan=Lasting(sec=1))", "lifespan takes a Duration of rclpy.duration", "write `Duration(seconds=...)` instead of `Lasting(sec=1)`, with"),
        ("qos = QoSProfile(depth=5)\n    qos.deadline = datetime.timedelta(seconds=1)", "deadline takes a Duration", "write `Duration(seconds=...)` instead of `datetime.timedelta(seconds=1)`"),
    ],
)  # fmt: skip
def test_the_type_that_rclpy_asserts_is_told(tmp_path: Path, line: str, cause: str, fix: str) -> None:
    path = written(line, tmp_path)
    (told, *_) = of_text(f"$ ros2 run a b\n{printed_by(path)}", tmp_path)
    assert told.code == "argument-type"
    assert cause in told.cause
    assert fix in told.fix
    new, old = re.findall(r"`([^`]+)`", told.fix)[:2]
    if " or " in told.fix or "..." in new:
        return  # the student is to choose
    imported = re.search(r"with `([^`]+)` at the top", told.fix)
    text = path.read_text()
    body = text[text.index("def main") :]
    path.write_text((f"{imported[1]}\n" if imported else "") + text.replace(body, body.replace(old, new, 1)))
    assert "rror" not in printed_by(path)


def test_what_the_setter_of_a_message_asserts_is_told_of_the_message(tmp_path: Path) -> None:
    path = written("from std_msgs.msg import String\n    qos = String()\n    qos.data = 5", tmp_path)
    (told, *_) = of_text(printed_by(path), tmp_path)
    assert told.code == "made-wrong"
    assert "data holds a string" in told.cause


@pytest.mark.parametrize(
    "line", ["qos = 'none'\n    assert isinstance(qos, QoSProfile)", "qos = QoSProfile(dept=5)"]
)
def test_another_assertion_is_not_about_a_value(tmp_path: Path, line: str) -> None:
    path = written(line, tmp_path)
    assert all(" is none." not in one.cause for one in of_text(printed_by(path), tmp_path))
