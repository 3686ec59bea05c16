"""A loop with a rhythm of its own that calls spin_once: it stands still until a callback is due."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of
from workspace_files import NAMES, Files

from ros2lab import assignments
from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.spin_loops import stands_still
from ros2lab.diagnose.sources.entrance import Entrance
from ros2lab.grading.evidence import Run
from ros2lab.trial.seen import Seen
from ros2lab.trial.story import told_of

HEAD = """\
import time

import rclpy
from std_msgs.msg import Int32, UInt16


"""
CLASS = """\
class Metronome(rclpy.node.Node):
    def __init__(self):
        super().__init__('metronome')
        self.bpm = 120
        self.pub = self.create_publisher(Int32, 'beat', 10)
        {more}

    def on_bpm(self, msg):
        self.bpm = msg.data

    def click(self):
        self.pub.publish(Int32(data=1))


def main():
    rclpy.init()
    node = Metronome()
    while rclpy.ok():
        {loop}
"""
FUNCTIONS = """\
def main():
    rclpy.init()
    node = rclpy.create_node('metronome')
    pub = node.create_publisher(Int32, 'beat', 10)
    while rclpy.ok():
        {loop}
"""
TAIL = "\n\nif __name__ == '__main__':\n    main()\n"
TAKES = "self.create_subscription(UInt16, 'bpm', self.on_bpm, 10)"
TIMED = "self.create_timer(0.1, self.click)"
BEATS = ("rclpy.spin_once(node)", "node.click()", "time.sleep(60 / node.bpm)")


def codes(tmp_path: Path, written: str) -> list[str]:
    files = Files.right(NAMES[1]).put("driver", HEAD + written + TAIL)
    return [finding.code for finding in of_workspace(files.write(tmp_path))]


def of_class(more: str, *loop: str) -> str:
    return CLASS.format(more=more, loop="\n        ".join(loop))


@pytest.mark.parametrize(
    "written",
    [
        of_class(TAKES, *BEATS),
        of_class(TAKES, "node.click()", "rclpy.spin_once(node)", "time.sleep(1.0)"),
        of_class("pass", "rclpy.spin_once(node)", "node.click()"),
        of_class("pass", "node.click()", "time.sleep(0.1)", "rclpy.spin_once(node)"),
        of_class("pass", *BEATS),
        FUNCTIONS.format(loop="pub.publish(Int32())\n        rclpy.spin_once(node)"),
        of_class("pass", "node.click()", "break\n    rclpy.spin_once(node)"),
        of_class("pass", "break\n    for _ in range(3):\n        rclpy.spin_once(node)"),
        of_class("pass", "node.turn()").replace("    def click", "    def turn(self):\n        rclpy.spin_once(self)\n\n    def click"),
    ],
)  # fmt: skip
def test_a_loop_that_stands_still(tmp_path: Path, written: str) -> None:
    assert "callback-waits" in codes(tmp_path, written)


@pytest.mark.parametrize(
    "written",
    [
        of_class(TAKES, "rclpy.spin_once(node, timeout_sec=0)", *BEATS[1:]),
        of_class(TAKES, "rclpy.spin_once(node)", "node.click()"),  # it answers each message
        of_class(TAKES, "rclpy.spin_once(node)", "node.click()", "time.sleep(0.01)"),
        of_class(TAKES, "rclpy.spin_once(node)", "time.sleep(0.01)"),
        of_class("pass", "rclpy.spin_once(node)"),
        of_class(TIMED, "rclpy.spin_once(node)", "node.get_name()"),
        of_class("pass", "break\n    rclpy.spin_once(node, timeout_sec=1.0)"),
        of_class(TAKES, "break\n    rclpy.spin_once(node)"),  # it waits for one message
        of_class("pass", "break\n    rclpy.spin_once(node)").replace("rclpy.node.Node", "LifecycleNode").replace("class M", "from rclpy.lifecycle import LifecycleNode\n\n\nclass M"),
        of_class(TAKES, "rclpy.spin_once(node)", "node.click()", "break"),
        of_class("self.listener = TransformListener(Buffer(), self)", "rclpy.spin_once(node)", "node.click()").replace("class M", "from tf2_ros import Buffer, TransformListener\n\n\nclass M"),
        of_class(TAKES, *BEATS).replace("rclpy.node.Node", "Clocked").replace("class M", "from tick import Clocked\n\n\nclass M"),
    ],
)  # fmt: skip
def test_a_loop_that_goes_on(tmp_path: Path, written: str) -> None:
    assert "callback-waits" not in codes(tmp_path, written)


@pytest.mark.parametrize(
    ("loop", "fix"),
    [
        (("rclpy.spin_once(node)", "node.click()"), "write rclpy.spin_once(node, timeout_sec=0.1)"),
        (("node.click()", "rclpy.spin_once(node)"), "write rclpy.spin_once(node, timeout_sec=0.1)"),
        (
            ("rclpy.spin_once(node)", "node.click()", "time.sleep(0.01)"),
            "write rclpy.spin_once(node, timeout_sec=0)",
        ),
        (("rclpy.spin_once(node, timeout_sec=0.1)", "node.click()"), ""),
        (("rclpy.spin_once(node)",), ""),
    ],
)
def test_a_loop_of_a_program_that_gets_no_message(tmp_path: Path, loop: tuple[str, ...], fix: str) -> None:
    sources = sources_of(HEAD + of_class(TAKES, *loop), tmp_path)
    found = [*stands_still(Entrance(sources, "pk.node.main"), gets_nothing=True)]
    assert [one.fix.startswith(f"{fix} instead") for one in found] == [True] * bool(fix)


def test_an_executor_that_waits(tmp_path: Path) -> None:
    made = "node = Metronome()\n    executor = rclpy.executors.SingleThreadedExecutor()\n    executor.add_node(node)"
    text = of_class(TAKES, "executor.spin_once()", "node.click()").replace("node = Metronome()", made)
    sources = sources_of(HEAD + text, tmp_path)
    (found,) = stands_still(Entrance(sources, "pk.node.main"), gets_nothing=True)
    assert found.fix.startswith("write executor.spin_once(timeout_sec=0.1) instead")


def test_the_story_of_a_run_without_messages_names_the_loop(tmp_path: Path) -> None:
    loop = of_class(TAKES, "rclpy.spin_once(node)", "node.click()")
    look = Look(Files.right(NAMES[1]).put("driver", HEAD + loop + TAIL).write(tmp_path))
    run = Run(
        programs=[NAMES[1].driver],
        setting="alone",
        clock="stepped",
        nodes=["/metronome"],
        publishes={},
        subscribes={"/bpm": {"/metronome": ["std_msgs/msg/UInt16"]}},
        qos={},
        parameters={},
        quiet={},
        commands=[],
        ended={},
        stopped={},
        notes=[],
    )
    said = told_of(Seen(look, assignments.load(), [run], []), run, set())
    assert "until then the loop stands still (" in said
    assert "rclpy.spin_once(node, timeout_sec=0.1) instead of" in said


@pytest.mark.parametrize(
    ("written", "fix"),
    [
        (of_class("pass", "node.click()", "rclpy.spin(node)"), "write rclpy.spin_once(node, timeout_sec=1.0) instead of"),
        (of_class("pass", "node.pub.publish(Int32())", "rclpy.spin(node)"), "write rclpy.spin_once("),
        (of_class(TAKES, "node.click()", "rclpy.spin(node)"), "call it in a timer callback"),
        (of_class(TAKES, "rclpy.spin(node)"), ""),
        (of_class(TAKES, "print('on')", "rclpy.spin(node)"), ""),
        (of_class(TIMED, "rclpy.spin(node)", "node.click()"), ""),
        (of_class(TIMED, "node.click()", "try:", "    rclpy.spin(node)", "except KeyError:", "    pass"), ""),
        (of_class("pass", "node.click()", "rclpy.spin_once(node, timeout_sec=1.0)"), ""),
        (of_class(TIMED, "node.click()", "rclpy.spin(node)").replace("rclpy.ok()", "not node.get_name()"), ""),
    ],
)  # fmt: skip
def test_a_loop_that_has_only_one_turn(tmp_path: Path, written: str, fix: str) -> None:
    files = Files.right(NAMES[1]).put("driver", HEAD + written + TAIL)
    found = [one.fix for one in of_workspace(files.write(tmp_path)) if "only one turn" in one.cause]
    assert len(found) == bool(fix)
    assert all(one.startswith(fix) for one in found)
