"""What is told of a line only if it holds on every way to it, and of a name only by what is at hand."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_grounds import package

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.finding import Finding

FILE = """\
import rclpy
import threading
from contextlib import suppress
from functools import partial
from rclpy.action import ActionServer
from rclpy.node import Node
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from std_msgs.msg import Float32


class Demo(Node):
    def __init__(self, mode='sim'):
{made}

    def got(self, msg):
        self.get_logger().info(str(msg.data))

    def add(self, request, response):
        response.sum = request.a + request.b
        return response

    def run(self, goal_handle):
        goal_handle.succeed()
        return Fibonacci.Result()

    def tick(self):
        self.get_logger().info('tick')
        return True

    def _start(self, name):
        super().__init__(name)

    def ending(self):
        if rclpy.ok():
            rclpy.shutdown()

    def make(self, name):
        return partial(print, name)


def main():
    rclpy.init()
{main}
"""


def lines(text: str, indent: int) -> str:
    return "".join(f"{' ' * indent}{line}\n" for line in text.splitlines()).rstrip()


def found(root: Path, made: str = "super().__init__('n')", main: str = "rclpy.spin(Demo())") -> list[Finding]:
    text = FILE.format(made=lines(made, 8), main=lines(main, 4))
    compile(text, "", "exec")
    for path, content in package("a", {"talk": text}).items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(content, encoding="utf-8")
    return [f for f in of_workspace(root) if not f.code.startswith(("dependency", "never-called"))]


@pytest.mark.parametrize(
    "made",
    [
        "if mode == 'sim':\n    super().__init__('a')\n    self.create_timer(1, self.tick)\nelse:\n    super().__init__('b')",
        "try:\n    super().__init__(mode)\n    self.get_logger().info(mode)\nexcept ValueError:\n    super().__init__('b')",
        "match mode:\n    case 'sim':\n        super().__init__('a')\n        self.get_clock()\n    case _:\n        super().__init__('b')",
        "self._start(mode)\nself.create_timer(1, self.tick)",
        "for name in ('', 'n'):\n    if name:\n        super().__init__(name)\n        self.get_clock()",
        "self.later = lambda: self.get_clock()\nsuper().__init__('n')",
    ],
)
def test_a_node_may_be_made_in_each_branch(tmp_path: Path, made: str) -> None:
    assert "super-late" not in {finding.code for finding in found(tmp_path, made)}


@pytest.mark.parametrize(
    ("made", "fix"),
    [
        (
            "if mode:\n    self.get_clock()\n    super().__init__('a')\nelse:\n    super().__init__('b')",
            "move the call of super().__init__() from line 16 up to above line 15",
        ),
        (
            "self.get_clock()\nif mode:\n    super().__init__('a')\nelse:\n    super().__init__('b')",
            "move line 14 down to below line 18",
        ),
        ("self.get_clock()\nname = 'n'\nsuper().__init__(name)", "move line 14 down to below line 16"),
        (
            "if mode:\n    super().__init__('a')\n    return\nself.get_clock()\nsuper().__init__('b')",
            "move the call of super().__init__() from line 18 up to above line 17",
        ),
    ],
)
def test_what_comes_before_the_node_on_its_own_way_is_moved(tmp_path: Path, made: str, fix: str) -> None:
    assert [f.fix for f in found(tmp_path, made) if f.code == "super-late"] == [fix]


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ("{'state': 'IDLE', 'n': 0}", "self.v['n'] += 1"),
        ("{'n': 0, 'state': 'IDLE'}", "self.v['state'] += '!'"),
        ("['IDLE', 0]", "self.v[1] -= 1"),
        ("dict(name='robot', n=0.0)", "self.v['n'] *= 0.5"),
        ("[['a', 1], ['b', 2]]", "for row in self.v:\n    row[1] += 1"),
        ("{'tick': self.tick, 'got': self.got}", "self.v['got'](Float32())\nself.v['tick']()"),
    ],
)
def test_a_value_of_several_types_may_be_of_the_right_one(tmp_path: Path, values: str, line: str) -> None:
    assert not found(tmp_path, f"super().__init__('n')\nself.v = {values}\n{line}")


def test_a_value_of_one_wrong_type_is_told(tmp_path: Path) -> None:
    made = "super().__init__('n')\nself.v = {'name': 'robot'}\nself.v['name'] += 1"
    assert [finding.code for finding in found(tmp_path, made)] == ["operand-type"]


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("self.create_service(AddTwoInts, 's', self.add())", "self.add"),
        ("self.create_service(srv_type=AddTwoInts, srv_name='s', callback=self.add())", "self.add"),
        ("ActionServer(self, Fibonacci, 'f', self.run())", "self.run"),
        ("ActionServer(self, Fibonacci, 'f', execute_callback=self.run())", "self.run"),
        ("self.create_subscription(Float32, 't', self.got(), 10)", "self.got"),
        ("self.create_timer(1.0, self.tick())", "self.tick"),
        ("self.add_on_set_parameters_callback(self.got())", "self.got"),
        ("threading.Thread(target=self.tick()).start()", "self.tick"),
    ],
)
def test_a_callback_that_is_called_loses_its_parentheses(tmp_path: Path, line: str, fix: str) -> None:
    told = found(tmp_path, f"super().__init__('n')\n{line}")
    assert [finding.code for finding in told] == ["callback-called"]
    assert told[0].fix.startswith(f"write `{fix}` instead of ") or told[0].fix.endswith(f"{fix}`")


def test_what_makes_a_callback_is_called(tmp_path: Path) -> None:
    assert not found(tmp_path, "super().__init__('n')\nself.create_timer(1.0, self.make('a'))")


@pytest.mark.parametrize(
    "end",
    [
        "try:\n    rclpy.shutdown()\nexcept Exception:\n    pass",
        "with suppress(RuntimeError):\n    rclpy.shutdown()",
        "rclpy.try_shutdown()",
    ],
)
def test_a_second_shutdown_may_be_caught(tmp_path: Path, end: str) -> None:
    made = "super().__init__('n')\nself.create_timer(1.0, self.ending)"
    assert not found(tmp_path, made, f"rclpy.spin(Demo())\n{end}")


@pytest.mark.parametrize(
    "end", ["rclpy.shutdown()", "try:\n    rclpy.shutdown()\nexcept KeyError:\n    pass"]
)
def test_a_second_shutdown_that_fails_is_told(tmp_path: Path, end: str) -> None:
    made = "super().__init__('n')\nself.create_timer(1.0, self.ending)"
    told = found(tmp_path, made, f"rclpy.spin(Demo())\n{end}")
    assert [finding.code for finding in told] == ["shutdown-in-callback"]


def test_nothing_helps_what_is_sent_after_the_end(tmp_path: Path) -> None:
    main = "node = Demo()\nrclpy.spin(node)\npub = node.create_publisher(Float32, 't', 10)\npub.publish(Float32())"
    assert not found(tmp_path, main=main)


@pytest.mark.parametrize(
    ("main", "fix"),
    [
        ("talker = Demo()\nrclpy.spin(talker)\nnode.destroy_node()", "write `talker.destroy_node()`"),
        ("node = Demo()\nrclpy.spin(node)\ndemo.destroy_node()", "write `node.destroy_node()`"),
        ("node = Demo()\nrclpy.spin(node)\nnode.destroy_node", "write node.destroy_node()"),
        ("talker = Demo()\nrclpy.spin(node)", "write `rclpy.spin(talker)`"),
        ("node = Demo()\nrclpy.spin(node)\nNode.destroy_node()", "write `node.destroy_node()`"),
        ("talker = Demo()\nrclpy.spin(talker)\nNode.destroy_node()", "write `talker.destroy_node()`"),
        (
            "node = Demo()\nrclpy.spin(node)\nNode.destroy_timer('tick')",
            "remove `Node.destroy_timer('tick')`: node.destroy_node() destroys its timers, too",
        ),
        (
            "node = Demo()\ntry:\n    rclpy.spin(node)\nexcept:\n    print(e)",
            "write `except Exception as e:` on line 47",
        ),
        (
            "node = Demo()\ntry:\n    rclpy.spin(node)\nexcept (OSError, ValueError):\n    print(f'{err}')",
            "write `except (OSError, ValueError) as err:` on line 47",
        ),
    ],
)
def test_what_is_at_hand_is_meant(tmp_path: Path, main: str, fix: str) -> None:
    assert fix in [finding.fix for finding in found(tmp_path, main=main)]


@pytest.mark.parametrize(
    ("main", "fix"),
    [
        (
            "node = Demo()\nwhile rclpy.ok():\n    node.got()",
            "write `rclpy.spin_once(node)` instead of `node.got()`",
        ),
        ("node = Demo()\nnode.got()\nrclpy.spin(node)", "remove `node.got()`"),
    ],
)
def test_ros_calls_a_callback(tmp_path: Path, main: str, fix: str) -> None:
    made = "super().__init__('n')\nself.create_subscription(Float32, 't', self.got, 10)"
    assert fix in [finding.fix for finding in found(tmp_path, made, main)]
