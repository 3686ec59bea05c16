"""Nodes whose only output is logged at a level that is not shown."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_workspace

NODE = """\
import logging

import rclpy
from rclpy.node import Node


class Cart(Node):
    def __init__(self):
        super().__init__('cart')
        self.log = self.get_logger()
        self.create_timer(0.5, self.move)
        SET

    def move(self):
        LOGS


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Cart())
"""
LEVEL = "self.get_logger().set_level(rclpy.logging.LoggingSeverity."


@pytest.mark.parametrize(
    ("begin", "logs", "fixes"),
    [
        ("pass", "self.log.debug('on')", ["write info instead of debug"]),
        ("pass", "self.get_logger().debug('on')", ["write info instead of debug"]),
        (f"{LEVEL}WARN)", "self.log.info('on')", [f"remove `{LEVEL}WARN)`"]),
        ("pass", "logging.getLogger('cart').info('on')", ["write `self.get_logger().info(...)` instead"]),
        ("pass", "self.log.debug('on')\n        self.log.info('off')", []),
        ("self.log.info('ready')", "self.log.debug('on')", []),
        (f"{LEVEL}DEBUG)", "self.log.debug('on')", []),
        ("logging.basicConfig(level=logging.INFO)", "logging.getLogger('cart').info('on')", []),
        ("pass", "logging.getLogger('cart').warning('on')", []),
        ("pass", "print('on')\n        self.log.debug('on')", []),
    ],
)
def test_only_who_shows_nothing_is_told(tmp_path: Path, begin: str, logs: str, fixes: list[str]) -> None:
    code = NODE.replace("SET", begin).replace("LOGS", logs)
    found = of_workspace(right_workspace().put("node", code).write(tmp_path))
    told = [finding.fix for finding in found if finding.code == "never-shown"]
    assert len(told) == len(fixes)
    assert all(shown.startswith(fix) for shown, fix in zip(told, fixes, strict=True))
