"""Variables of ROS that one program sets for itself, so that it does not meet the others, or sets too late."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.finding import Finding

NODE = """\
import os
TOP

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Radio(Node):
    def __init__(self):
        super().__init__('NAME')
        MADE

    def heard(self, msg):
        self.get_logger().info(msg.data)

    def send(self):
        self.pub.publish(String(data='over'))


def main(args=None):
    BEFORE
    rclpy.init(args=argsGIVEN)
    AFTER
    rclpy.spin(Radio())
"""
SPEAKS = "self.pub = self.create_publisher(String, 'radio', 10)\n        self.create_timer(0.5, self.send)"
HEARS = "self.create_subscription(String, 'radio', self.heard, 10)"


def found_in(root: Path, sender: dict[str, str], receiver: dict[str, str]) -> list[Finding]:
    files = right_workspace()
    for name, made, changed in (("node", SPEAKS, sender), ("listener", HEARS, receiver)):
        words = {"TOP": "", "BEFORE": "pass", "GIVEN": "", "AFTER": "pass", "NAME": name, **changed}
        code = NODE.replace("MADE", made)
        for word, text in words.items():
            code = code.replace(word, text, 1)
        files.texts[files.path(name)] = code
    return [found for found in of_workspace(files.write(root)) if found.code == "environment-apart"]


@pytest.mark.parametrize(
    ("sender", "fix"),
    [
        ({"TOP": "os.environ['ROS_DOMAIN_ID'] = '42'"}, "remove `os.environ['ROS_DOMAIN_ID'] = '42'`"),
        ({"TOP": "os.environ.setdefault('RMW_IMPLEMENTATION', 'rmw_cyclonedds_cpp')"}, "remove "),
        ({"TOP": "WHICH = 'ROS_DOMAIN_ID'\nos.environ[WHICH] = str(9)"}, "remove "),
        ({"BEFORE": "os.environ.update({'ROS_DOMAIN_ID': '7'})"}, "remove "),
        ({"BEFORE": "os.putenv('ROS_LOCALHOST_ONLY', '1')"}, "remove "),
        ({"GIVEN": ", domain_id=42"}, "write `rclpy.init(args=args)`"),
        ({"AFTER": "os.environ['ROS_DOMAIN_ID'] = '7'"}, "move this line above rclpy.init()"),
    ],
)
def test_what_one_program_sets_for_itself_is_told(tmp_path: Path, sender: dict[str, str], fix: str) -> None:
    (found,) = found_in(tmp_path, sender, {})
    assert found.place.partition(":")[0].endswith("status_publisher.py")
    assert found.fix.startswith(fix)


@pytest.mark.parametrize(
    ("sender", "receiver"),
    [
        (
            {"TOP": "os.environ['ROS_DOMAIN_ID'] = '42'"},
            {"BEFORE": "os.environ.setdefault('ROS_DOMAIN_ID', '42')"},
        ),
        ({"TOP": "os.environ['RCUTILS_COLORIZED_OUTPUT'] = '1'"}, {}),
        ({"TOP": "os.environ['ROS_DOMAIN_ID'] = '0'"}, {}),
        ({"TOP": "os.environ['ROS_DOMAIN_ID'] = os.environ.get('TEAM', '0')"}, {}),
        ({"TOP": "import subprocess", "AFTER": "os.environ['ROS_DOMAIN_ID'] = '7'"}, {}),
    ],
)
def test_what_all_share_or_what_parts_nobody_is_right(
    tmp_path: Path, sender: dict[str, str], receiver: dict[str, str]
) -> None:
    assert found_in(tmp_path, sender, receiver) == []
