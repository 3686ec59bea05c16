"""What a publisher or a client sends: one message, and not its fields."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.nodes.message_faults import message_faults
from ros2lab.diagnose.nodes.node_faults import node_faults

FILE = """\
import rclpy
from mavros_msgs.srv import SetMode
from rclpy.action import ActionClient
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Empty, SetBool, Trigger
from tf2_msgs.action import LookupTransform


class Robot(Node):
    def __init__(self):
        super().__init__('robot')
        self.pub = self.create_publisher(String, 'said', 10)
        self.cli = self.create_client(SetBool, 'on')
        self.empty = self.create_client(Empty, 'none')
        self.mode = self.create_client(SetMode, 'mode')
        self.act = ActionClient(self, LookupTransform, 'look')
        self.request = SetBool.Request()
        self.total = 0
        self.create_timer(1.0, self.tick)

    def tick(self):
        self.request.data = True
        {line}

    def look(self, given):
        self.cli.call_async(given)


def main():
    rclpy.init()
    node = Robot()
    {main}
    rclpy.spin(node)
"""


def told(folder: Path, line: str = "pass", main: str = "pass") -> list[str]:
    sources = sources_of(FILE.format(line=line, main=main), folder)
    return [finding.fix for finding in [*message_faults(sources), *node_faults(sources)]]


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("self.cli.call_async(True)", "write call_async(SetBool.Request(data=True))"),
        ("self.cli.call(True)", "write call(SetBool.Request(data=True))"),
        ("self.cli.call_async(data=True)", "write `self.cli.call_async(SetBool.Request(data=True))`"),
        ("self.cli.call_async(0, True)", "write `self.cli.call_async(SetBool.Request())`, with these values in its fields (data)"),
        ("self.mode.call_async(0, self.total)", "write `self.mode.call_async(SetMode.Request())`, with these values in its fields (ros2 interface show lists them)"),
        ("self.empty.call_async()", "write `self.empty.call_async(Empty.Request())`"),
        ("self.cli.call_async(SetBool())", "write call_async(SetBool.Request())"),
        ("self.cli.call_async(SetBool.Request)", "write call_async(SetBool.Request())"),
        ("self.cli.call_async(Trigger.Request())", "write `self.create_client(Trigger, 'on')` on line 14, or send a SetBool.Request here"),
        ("self.request.data = 'on'", "write self.request.data = True"),
        ("self.pub.publish(data='x')", "write `self.pub.publish(String(data='x'))`"),
        ("self.pub.publish('a', 'b')", "write `self.pub.publish(String())`, with these values in its fields (data)"),
        ("self.act.send_goal_async('map')", "put it into a LookupTransform.Goal first"),
        ("self.total_ += 1", "write self.total, or define self.total_ in __init__"),
    ],
)  # fmt: skip
def test_values_belong_in_what_is_sent(tmp_path: Path, line: str, fix: str) -> None:
    (said,) = told(tmp_path, line)
    assert said.startswith(fix)


def test_what_a_variable_holds_is_followed(tmp_path: Path) -> None:
    assert told(tmp_path, main="node.pub.publish('x')") == ["write publish(String(data='x'))"]
    assert told(tmp_path, main="node.pub = make()\n    node.pub.publish('x')") == []


@pytest.mark.parametrize(
    "line",
    [
        "self.cli.call_async(self.request)",
        "self.cli.call_async(request=self.request)",
        "self.cli.call_async(SetBool.Request(data=True))",
        "self.cli.call_async(requst=self.request)",  # the type checker says so
        "self.act.send_goal_async(LookupTransform.Goal(), feedback_callback=self.look)",
        "self.act.send_goal_async(feedback_callback=self.look)",
        "self.mode.call_async(SetMode.Request())",
        "self.total += 1",
    ],
)
def test_a_message_is_sent_as_it_is(tmp_path: Path, line: str) -> None:
    assert told(tmp_path, line) == []
