"""A node that was added to an executor, and that another one takes away."""

from __future__ import annotations

import textwrap

import pytest

from ros2lab.diagnose.nodes.executors import several_threads, two_executors
from ros2lab.diagnose.sources.entrance import Entrance
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource

HEAD = """\
import threading
import rclpy
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node


class Server(Node):
    def __init__(self):
        super().__init__('server')

    def prepare(self):
        future = self.cli.call_async(self.req)
        rclpy.spin_until_future_complete(self, future)

    def ready(self):
        self.prepare()


def main():
    rclpy.init()
    node = Server()
    other = Server()
    executor = MultiThreadedExecutor()
    future = other.cli.call_async(1)
"""
ADD, SPIN = "executor.add_node(node)\n", "executor.spin()"
THREAD = "threading.Thread(target=executor.spin, daemon=True).start()\n"
UNTIL = "rclpy.spin_until_future_complete(node, future)\n"
WRONG = [
    (ADD + "rclpy.spin_once(node)\n" + SPIN, "write `executor.spin_once()`"),
    (ADD + "rclpy.spin_once(node, timeout_sec=1.0)\n" + SPIN, "write `executor.spin_once(timeout_sec=1.0)`"),
    (ADD + UNTIL + SPIN, "write `executor.spin_until_future_complete(future)`"),
    (ADD + "while not node.done:\n    rclpy.spin_once(node)\n" + SPIN, "write `executor.spin_once()`"),
    (ADD + "while rclpy.ok():\n    executor.spin_once()\n    rclpy.spin_once(node)\n", "write `executor.spin_once()`"),
    (ADD + UNTIL + "while rclpy.ok():\n    executor.spin_once()\n", "write `executor.spin_until_future_complete(future)`"),
    (ADD + THREAD + UNTIL, "write `while not future.done(): time.sleep(0.01)`"),
    (ADD + "second = SingleThreadedExecutor()\nsecond.add_node(node)\n" + SPIN, "remove `second.add_node(node)`"),
    ("for one in (node, other):\n    executor.add_node(one)\nrclpy.spin_once(node)\n" + SPIN, "write `executor.spin_once()`"),
    (ADD + "node.prepare()\n" + SPIN, "write `self.executor.spin_until_future_complete(future)`"),
    (ADD + "rclpy.spin(node)", "write `executor.spin()` instead of `rclpy.spin(node)`"),
    (ADD + "try:\n    rclpy.spin(node)\nfinally:\n    executor.shutdown()", "write `executor.spin()`"),
    (ADD + "rclpy.spin(other)", "write `executor.add_node(other)` and `executor.spin()` instead"),
    (ADD + "node.ready()\n" + SPIN, "write `self.executor.spin_until_future_complete(future)`"),
]  # fmt: skip
RIGHT = [
    UNTIL + ADD + SPIN,
    "node.prepare()\n" + ADD + SPIN,
    ADD + "rclpy.spin_once(node, executor=executor)\n" + SPIN,
    ADD + "rclpy.spin_until_future_complete(node, future, executor)\n" + SPIN,
    ADD + "rclpy.spin_until_future_complete(other, future)\n" + SPIN,
    ADD + "executor.spin_until_future_complete(future)\n" + SPIN,
    ADD + "second = SingleThreadedExecutor()\nsecond.add_node(other)\n" + SPIN,
    "rclpy.spin(node)",
    ADD + f"try:\n    {SPIN}\nfinally:\n    {UNTIL}",
    ADD + f"try:\n    {SPIN}\nexcept KeyboardInterrupt:\n    node.ready()\n",
    ADD + f"try:\n    {SPIN}\nfinally:\n    executor.shutdown()\n    {UNTIL}",
    ADD + "executor.spin_once()\n" + UNTIL,
    ADD + "rclpy.spin(node, executor=executor)",
    ADD + "node.run(executor)\nrclpy.spin(other)",
    ADD.replace("executor", "alone") + "rclpy.spin(node)",
    "alone = SingleThreadedExecutor()\n" + ADD.replace("executor", "alone") + "rclpy.spin(node)",
    ADD + "executor.spin_once()\nexecutor.remove_node(node)\n" + UNTIL + SPIN,
    ADD + "executor.add_node(node.nav)\ntry:\n    " + SPIN + "\nfinally:\n    rclpy.spin_once(node.nav)\n",
    ADD + "executor.add_node(node.nav)\nrclpy.spin_once(node.map)\n" + SPIN,
]


def found(lines: str) -> list[str]:
    made = "" if "other" in lines else "    other = Server()\n"
    text = HEAD.replace(made, "").replace("other.cli", "node.cli" if made else "other.cli")
    text = f"{text}{textwrap.indent(lines, '    ')}\n"
    sources = NodeSources({"pk.a": PythonSource("pk.a", "a.py", text)})
    return [one.fix for one in two_executors(Entrance(sources, "pk.a.main"))]


@pytest.mark.parametrize(("lines", "fix"), WRONG)
def test_what_takes_the_node_away_is_told(lines: str, fix: str) -> None:
    (told,) = found(lines)
    assert told.startswith(fix)


@pytest.mark.parametrize("lines", RIGHT)
def test_a_node_that_stays_where_it_is_is_right(lines: str) -> None:
    assert found(lines) == []


IN_CLASS = """\
import rclpy


class Server(Node):
    def __init__(self):
        super().__init__('server')
        self.own = MultiThreadedExecutor()
        BEFORE
        self.own.add_node(self)
        AFTER

    def start(self):
        rclpy.spin_until_future_complete(self, self.future)


def main():
    node = Server()
    node.own.spin()
    node.start()
    self.own.spin()
"""


@pytest.mark.parametrize(
    ("before", "after", "is_told"),
    [
        ("pass", "pass", True),
        ("self.start()", "pass", False),
        ("pass", "self.create_timer(1.0, self.start)", False),
    ],
)
def test_a_node_that_adds_itself(before: str, after: str, is_told: bool) -> None:
    text = IN_CLASS.replace("BEFORE", before).replace("AFTER", after)
    sources = NodeSources({"pk.a": PythonSource("pk.a", "a.py", text)})
    assert bool([*two_executors(Entrance(sources, "pk.a.main"))]) is is_told


OWN = """\
import threading
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Hive(Node):
    def __init__(self):
        super().__init__('hive')
        SPUN


def main():
    rclpy.init()
    node = Hive()
MAIN
"""
SPINS = "threading.Thread(target=rclpy.spin, args=(NODE,), daemon=True).start()"
OF_SELF, OF_NODE = SPINS.replace("NODE", "self"), SPINS.replace("NODE", "node")


def told_of_threads(spun: str, lines: str) -> list[str]:
    text = OWN.replace("SPUN", spun).replace("MAIN", textwrap.indent(lines, "    "))
    sources = NodeSources({"pk.a": PythonSource("pk.a", "a.py", text)})
    return [one.code for one in several_threads(Entrance(sources, "pk.a.main"))]


@pytest.mark.parametrize(
    ("spun", "lines"),
    [
        (OF_SELF, "hives = [Hive() for _ in range(3)]"),
        (OF_SELF, "other = Hive()"),
        (OF_SELF, "for _ in range(2):\n    Hive()"),
        ("pass", f"{OF_NODE}\nrclpy.spin(node)"),
        ("pass", f"{OF_NODE}\nrclpy.spin_until_future_complete(node, node.future)"),
        ("pass", f"{OF_NODE}\nother = Hive()\n{OF_NODE.replace('(node,)', '(other,)')}"),
        ("pass", f"for one in (node, Hive()):\n    {OF_NODE.replace('(node,)', '(one,)')}"),
    ],
)
def test_threads_that_share_an_executor_are_told(spun: str, lines: str) -> None:
    assert told_of_threads(spun, lines) == ["not-spinning"]


@pytest.mark.parametrize(
    ("spun", "lines"),
    [
        (OF_SELF, "pass"),
        ("pass", "rclpy.spin(node)"),
        ("pass", f"{OF_NODE}\nwhile rclpy.ok():\n    node.rate.sleep()"),
        ("pass", f"{OF_NODE}\nexecutor = SingleThreadedExecutor()\nrclpy.spin(Hive(), executor)"),
        ("pass", "executor = SingleThreadedExecutor()\nthreading.Thread(target=executor.spin).start()\nrclpy.spin(node)"),
        ("pass", "threading.Thread(target=node.work).start()\nrclpy.spin(node)"),
    ],
)  # fmt: skip
def test_one_thread_for_an_executor_is_right(spun: str, lines: str) -> None:
    assert told_of_threads(spun, lines) == []
