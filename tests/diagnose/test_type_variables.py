"""Members of what a type variable stands for: nothing is known of them, unless it is bound to a class."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

NODE = """\
from typing import Generic, TypeVar

import rclpy
from rclpy.node import Node
from std_msgs.msg import String

M = TypeVar('M'BOUND)


def first(items: list[M]) -> str:
    return items[0].FIELD


class Box(Generic[M]):
    def __init__(self) -> None:
        self.items: list[M] = []

    def last(self) -> str:
        return self.items[-1].FIELD


class Relay(Node):
    def __init__(self):
        super().__init__('relay')
        self.create_subscription(String, 'chat', self.on, 10)

    def on(self, msg):
        self.get_logger().info(first([msg]))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Relay())
"""


@pytest.mark.parametrize(
    ("bound", "field", "fixes"),
    [
        ("", "data", []),
        ("", "dta", []),
        (", bound=object", "data", []),
        (", bound=String", "data", []),
        (", bound=String", "dta", ["write data instead of dta"]),
    ],
)
def test_only_a_bound_type_variable_is_known(
    tmp_path: Path, bound: str, field: str, fixes: list[str]
) -> None:
    code = NODE.replace("BOUND", bound).replace("FIELD", field)
    found = of_workspace(Files.right(NAMES[0]).put("node", code).write(tmp_path))
    assert [finding.fix for finding in found if finding.code == "attribute-missing"] == fixes
