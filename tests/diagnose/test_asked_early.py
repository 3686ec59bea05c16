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

    def wait_for(self, future):
        rclpy.spin_once(self) if future is None else rclpy.spin_until_future_complete(self, future)

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
        (f"self.future = {CALL}\nif self.future.done():\n    self.tell()", "`self.future.done()` is never true here: line 29 has only just asked"),
        (f"later = {CALL}\ntime.sleep(0.5)\nif later.done(): self.tell()\nelse: print('no')", "write `later.add_done_callback(self.answered)`"),
        (f"later = {CALL}\nfor _ in range(9):\n    if later.done(): break\n    time.sleep(0.1)", "`later.done()` is never true here"),
        (f"later = {CALL}\nself.reply = later.result() if later.done() else None", "`later.done()` is never true here"),
        ("self.reply = None\nself.pub.publish(String())\nif self.reply: self.tell()", "`self.reply` always finds self.reply as line 29 has set it, None: only on_answer() changes it"),
        ("self.reply = None\nself.pub.publish(String())\ntime.sleep(0.1)\nif self.reply is not None: self.tell()", "test it at the next call of ask(), above line 29"),
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
        f"later = {CALL}\nself.wait_for(later)\nif later.done(): self.tell()",
        "self.reply = None\nself.pub.publish(String())\nself.wait_for(None)\nif self.reply is not None: self.tell()",
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


ON_SET = """\
import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from std_msgs.msg import Bool


class Blinker(Node):
    def __init__(self):
        super().__init__('blinker')
        self.declare_parameter('period', 1.0)
        self.pub = self.create_publisher(Bool, 'led', 10)
        self.apply()
        self.WHEN(self.changed)

    def apply(self):
        period = self.get_parameter('period').value
        self.timer = self.create_timer(period, lambda: self.pub.publish(Bool()))

    def changed(self, params):
        BODY
        return SetParametersResult(successful=RESULT)


def main():
    rclpy.init()
    rclpy.spin(Blinker())
"""
OLD = "self.apply()"


@pytest.mark.parametrize(
    ("when", "body", "result", "said"),
    [
        ("on", "for p in params:\n    if p.name == 'period':\n        self.apply()", "True", "write `self.add_post_set_parameters_callback(self.changed)`"),
        ("on", OLD, "True", "write `self.add_post_set_parameters_callback(self.changed)`"),
        ("on", "if 'period' in [p.name for p in params]:\n    self.apply()", "not self.timer.is_canceled()", "`.value` of the parameter of that name"),
        ("on", "self.period = self.get_parameter('period').value", "True", "one change behind"),
        ("on", "self.values = self.get_parameters(['period'])", "True", "one change behind"),
        ("on", "for p in params:\n    if p.name == 'period' and not 0 < p.value < 9:\n        return SetParametersResult(successful=False)\nself.period = self.get_parameter('period').value", "True", "`.value` of the parameter of that name"),
        ("on", "self.apply()", "all(p.value > 0 for p in params)", "`.value` of the parameter of that name"),
        ("post", OLD, "True", ""),  # the new value is there
        ("on", "for p in params:\n    self.timer.timer_period_ns = int(p.value * 1e9)", "True", ""),
        ("on", "self.before = self.get_parameter('period').value\nself.wanted = {p.name: p.value for p in params}", "True", ""),
        ("on", "self.take(params)", "True", ""),  # whatever that does
        ("on", "self.get_logger().info(str(self.get_parameter('period').value))", "True", ""),  # nothing is kept
        ("on", "self.is_stale = True", "True", ""),  # it is read later
    ],
)  # fmt: skip
def test_a_parameter_is_not_read_where_its_new_value_is_decided_on(
    tmp_path: Path, when: str, body: str, result: str, said: str
) -> None:
    code = ON_SET.replace("WHEN", f"add_{when}_set_parameters_callback")
    code = code.replace("BODY", body.replace("\n", "\n        ")).replace("RESULT", result)
    root = Files.right(NAME).put("node", code).write(tmp_path)
    told = [f"{one.cause} {one.fix}" for one in of_workspace(root) if one.code == "callback-waits"]
    assert [said in text for text in told] == [True] * bool(said), told
