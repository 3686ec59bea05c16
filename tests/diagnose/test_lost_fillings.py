"""Fields of a message that are filled when it is out already."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from ros2lab.diagnose.code.lost_fillings import lost_fillings
from ros2lab.diagnose.sources.python_source import read_source


@pytest.mark.parametrize(
    ("lines", "cause"),
    [
        ("P(msg); msg.linear.x = 1.0", "`msg.linear.x = 1.0` comes after"),
        ("P(msg)\n    if late:\n        msg.linear.x = 1.0", "`msg.linear.x = 1.0` comes after"),
        ("msg.linear.x = 1.0; P(msg); msg.angular.z = 0.5", "`msg.angular.z = 0.5` comes after"),
        ("msg.linear.x = 1.0; P(msg); msg.linear.x = 0.0", ""),
        ("msg.linear.x = 1.0; P(msg); msg.linear.x += 1.0", ""),
        ("msg.linear = V; P(msg); msg.linear.x = 0.0", ""),
        ("msg.linear.x = 1.0; P(msg); Q(msg); msg.linear.x = 0.0", ""),
        ("P(msg); msg.linear.x = 1.0; P(msg)", ""),
    ],
)
def test_only_what_was_never_filled_is_lost(tmp_path: Path, lines: str, cause: str) -> None:
    path = tmp_path / "a.py"
    lines = lines.replace("P(", "self.pub.publish(").replace("Q(", "self.other.publish(")
    path.write_text(
        f"from geometry_msgs.msg import Twist\ndef tick(self):\n    msg = Twist(); {lines}\n",
        encoding="utf-8",
    )
    source = read_source(path, "a", "a.py")
    (method,) = (node for node in source.nodes if isinstance(node, ast.FunctionDef))
    found = [fault.cause for fault in lost_fillings(source, method)]
    assert len(found) == bool(cause)
    assert all(said.startswith(cause) for said in found)
