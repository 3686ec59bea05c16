"""Members that an object lacks: who has them, and which of its own were meant."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

TALK = "        self.count += 1\n"
TOP = """\
import math
import time

from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy


def scaled(value, by=2):
    return value * by


"""
FIXES = [
    ("other = Node('a')\nrclpy.destroy_node(other)", "other.destroy_node()"),
    ("other = Node('a')\nother.spin()", "rclpy.spin(other)"),
    ("other = Node('a')\nother.shutdown()", "rclpy.shutdown()"),
    ("other = Node('a')\nother.sleep(1.0)", "time.sleep(1.0)"),
    ("other = Node('a')\nother.add_node(SingleThreadedExecutor())", ""),
    ("other = Node('a')\nteam = SingleThreadedExecutor()\nother.add_node(team)", "team.add_node(other)"),
    ("values = [1]\nmath.append(values, 2)", "values.append(2)"),
    ("values = 'abc'\nself.size = values.len()", "len(values)"),
    ("text = 'abc'\nself.text = text.scaled(3)", "scaled(text, 3)"),
    ("self.size = math.abs(-3)", "abs(-3)"),
    ("self.best = ReliabilityPolicy.RELIABILITY_BEST_EFFORT", "BEST_EFFORT instead of"),
    ("self.best = DurabilityPolicy.QOS_POLICY_DURABILITY_TRANSIENT_LOCAL", "TRANSIENT_LOCAL instead of"),
    ("self.best = ReliabilityPolicy.BESTEFFORT", "BEST_EFFORT instead of"),
    ("self.best = self.get_clock().get_now()", "now instead of"),
    ("self.get.logger().info('x')", "write self.get_logger instead of self.get.logger"),
    ("self.destroy.node()", "write self.destroy_node instead of self.destroy.node"),
    ("self.team = SingleThreadedExecutor()\nself.wake.team()", "write self.team.wake instead of self.wake.team"),
    ("self.late = 9.0\nprint(self.settings.late)", "settings"),
    ("self.best = Duration(seconds=1).secs", ""),
    ("self.best = self.get_clock().now().to_secs()", ""),
]  # fmt: skip


@pytest.mark.parametrize(("code", "fix"), FIXES)
def test_a_member_that_is_missing_is_asked_of_who_has_it(tmp_path: Path, code: str, fix: str) -> None:
    files = Files.right(NAMES[1]).change("node", TALK, TALK + textwrap.indent(f"{code}\n", " " * 8))
    files.change("node", "class CLASS", f"{TOP}class CLASS")
    (finding,) = of_workspace(files.write(tmp_path))
    assert finding.code == "attribute-missing"
    assert fix in finding.fix
    assert "self.late.settings" not in finding.fix
    assert fix or not finding.fix.startswith("write")
