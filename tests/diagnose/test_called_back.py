"""Whether a program has callbacks, without which it needs no spin; and a program that ended is not waiting."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from right_workspace import right_workspace
from test_trial import STRING, run_of

from ros2lab import assignments
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.entrance import Entrance
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.trial.seen import Seen, seen_faults

PROGRAM = """\
import functools
import threading
import time

import rclpy
from message_filters import Subscriber
from rclpy.action import ActionServer
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger
from tf2_ros import Buffer, TransformListener


class Talk(Node):
    def __init__(self):
        super().__init__('talk')
        self.pub = self.create_publisher(String, 'chatter', 10)
        MADE

    def tick(self, *given):
        self.pub.publish(String(data=str(given)))


def main():
    rclpy.init()
    talk = Talk()
    BODY
    while rclpy.ok():
        talk.tick()
        time.sleep(1.0)
"""
NONE = {
    "a publisher": ("pass", "pass"),
    "a client": ("self.ask = self.create_client(Trigger, 'ring')", "talk.ask.wait_for_service(timeout_sec=1.0)"),
    "a log and a parameter": ("self.declare_parameter('speed', 1.0)", "talk.get_logger().info(str(talk.get_parameter('speed').value))"),
    "a thread of its own": ("pass", "threading.Thread(target=talk.tick, daemon=True).start()"),
    "a result of its own": ("pass", "talk.get_logger().info(str(talk.tick()))"),
    "a rate": ("pass", "rate = talk.create_rate(2.0)"),
}  # fmt: skip
SOME = {
    "a subscription": ("self.create_subscription(String, 'word', self.tick, 10)", "pass"),
    "a timer": ("pass", "talk.create_timer(1.0, talk.tick)"),
    "a timer with arguments": ("self.create_timer(1.0, functools.partial(self.tick, 1))", "pass"),
    "a service": ("self.create_service(Trigger, 'ring', lambda asked, answer: answer)", "pass"),
    "an action": ("ActionServer(self, Talk, 'talk', self.tick)", "pass"),
    "a listener for transforms": ("pass", "listener = TransformListener(Buffer(), talk)"),
    "a filter": ("self.words = Subscriber(self, String, 'word')", "talk.words.registerCallback(talk.tick)"),
    "an answer": ("self.ask = self.create_client(Trigger, 'ring')", "talk.ask.call_async(Trigger.Request()).add_done_callback(talk.tick)"),
    "a function inside": ("pass", "def seen(msg):\n        print(msg)\n\n    talk.add_on_set_parameters_callback(seen)"),
}  # fmt: skip


@pytest.mark.parametrize("name", [*NONE, *SOME])
def test_what_only_a_spin_calls_is_told_from_what_runs_by_itself(name: str) -> None:
    made, body = (NONE | SOME)[name]
    text = PROGRAM.replace("MADE", made).replace("BODY", body)
    sources = NodeSources({"talk": PythonSource("talk", "talk.py", text)})
    assert Entrance(sources, "talk.main").has_callbacks == (name in SOME)


TIMER = "        self.timer = self.create_timer(0.5, self.timer_callback)\n"
SPIN = "        rclpy.spin(node)\n"
LOOP = "        while rclpy.ok():\n            node.timer_callback()\n            time.sleep(1.0)\n"


@pytest.mark.parametrize(
    ("timer", "spin", "told"),
    [
        ("", LOOP, []),
        (TIMER, LOOP, ["not-spinning"]),
        ("", "        time.sleep(9.0)\n", ["publishes-nothing"]),
    ],
)
def test_a_node_without_callbacks_needs_no_spin(
    tmp_path: Path, timer: str, spin: str, told: list[str]
) -> None:
    files = right_workspace().change("node", TIMER, timer).change("node", SPIN, spin)
    files.change("node", "import rclpy\n", "import time\n\nimport rclpy\n")
    run = replace(run_of("status_publisher", "/robot/report", STRING, None), parameters={})
    seen = Seen(Look(files.write(tmp_path)), assignments.load(), [run], [])
    found = [finding.code for finding in seen_faults(seen)]
    assert [code for code in found if code != "publishes-nothing" or spin != LOOP] == told


@pytest.mark.parametrize(("ended", "told"), [({}, ["no-node"]), ({"status_publisher": ""}, [])])
def test_a_program_that_has_ended_is_not_waiting(
    tmp_path: Path, ended: dict[str, str], told: list[str]
) -> None:
    run = run_of("status_publisher", "/robot/report", STRING, None)
    run = replace(run, nodes=[], publishes={}, parameters={}, ended=ended)
    seen = Seen(Look(right_workspace().write(tmp_path)), assignments.load(), [run], [])
    assert [finding.code for finding in seen_faults(seen)] == told
