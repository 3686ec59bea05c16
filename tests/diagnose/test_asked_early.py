"""What is asked in the call that has just begun it can only come later; what is asked at the next call may be there."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

NAME = NAMES[0]
NODE = """\
import time

import rclpy
from example_interfaces.srv import Trigger
from rclpy.node import Node
from std_msgs.msg import String


class Asker(Node):
    def __init__(self):
        super().__init__('asker')
        self.future = None
        self.reply = None
        self.pub = self.create_publisher(String, 'question', 10)
        self.client = self.create_client(Trigger, 'door')
        self.create_subscription(String, 'answer', self.on_answer, 10)
        self.create_timer(1.0, self.ask)

    def on_answer(self, msg):
        self.reply = msg.data

    def tell(self):
        self.get_logger().info(str(self.reply))

    def ask(self):
        BODY


def main():
    rclpy.init()
    rclpy.spin(Asker())
"""
CALL = "self.client.call_async(Trigger.Request())"


def found(body: str, folder: Path) -> list[str]:
    """Return what is said of a callback."""
    code = NODE.replace("BODY", body.replace("\n", "\n        "))
    root = Files.right(NAME).put("node", code).write(folder)
    return [f"{one.cause} {one.fix}" for one in of_workspace(root) if one.code == "callback-waits"]


@pytest.mark.parametrize(
    ("body", "said"),
    [
        (f"self.future = {CALL}\nif self.future.done():\n    self.tell()", "`self.future.done()` is never true here: line 26 has only just asked"),
        (f"later = {CALL}\ntime.sleep(0.5)\nif later.done(): self.tell()\nelse: print('no')", "write `later.add_done_callback(self.answered)`"),
        (f"later = {CALL}\nfor _ in range(9):\n    if later.done(): break\n    time.sleep(0.1)", "`later.done()` is never true here"),
        (f"later = {CALL}\nself.reply = later.result() if later.done() else None", "`later.done()` is never true here"),
        ("self.reply = None\nself.pub.publish(String())\nif self.reply: self.tell()", "`self.reply` always finds self.reply as line 26 has set it, None: only on_answer() changes it"),
        ("self.reply = None\nself.pub.publish(String())\ntime.sleep(0.1)\nif self.reply is not None: self.tell()", "test it at the next call of ask(), above line 26"),
    ],
)  # fmt: skip
def test_what_can_only_come_later_is_not_asked_at_once(tmp_path: Path, body: str, said: str) -> None:
    (text,) = found(body, tmp_path)
    assert said in text


@pytest.mark.parametrize(
    "body",
    [
        f"if self.future and self.future.done(): self.tell()\nself.future = {CALL}",
        f"if self.future is None: self.future = {CALL}\nif self.future.done(): self.tell()",
        f"self.future = {CALL}\nself.future.add_done_callback(lambda _: self.tell())",
        f"later = {CALL}\nrclpy.spin_until_future_complete(self, later)\nif later.done(): self.tell()",
        f"later = {CALL}\nlater = self.future\nif later and later.done(): self.tell()",
        "if self.reply is not None: self.tell()\nself.reply = None\nself.pub.publish(String())",
        "self.reply = None\nself.on_answer(String())\nself.pub.publish(String())\nif self.reply is not None: self.tell()",
        "self.reply = None\nif self.reply is not None: self.tell()",  # nothing is begun
        "self.future = False\nself.pub.publish(String())\nif self.future: self.tell()",  # no other callback sets it
    ],
)
def test_what_may_have_come_is_asked_rightly(tmp_path: Path, body: str) -> None:
    assert [text for text in found(body, tmp_path) if "spin" not in text] == []


def test_with_threads_it_may_come_meanwhile(tmp_path: Path) -> None:
    body = f"later = {CALL}\ntime.sleep(0.5)\nif later.done(): self.tell()"
    threads = "from rclpy.executors import MultiThreadedExecutor\nEXECUTOR = MultiThreadedExecutor\n\n\nclass"
    code = NODE.replace("BODY", body.replace("\n", "\n        ")).replace("class", threads, 1)
    root = Files.right(NAME).put("node", code).write(tmp_path)
    assert [one for one in of_workspace(root) if one.code == "callback-waits"] == []
