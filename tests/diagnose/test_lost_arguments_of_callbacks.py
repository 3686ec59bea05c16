"""What a callback's def lacks is told there, once; and a word alone on its line is to be removed."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.rules import source_faults

TEXT = """\
import math

import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionServer
from rclpy.node import Node
from std_msgs.msg import String


class Adder(Node):
    def __init__(self):
        super().__init__('adder')
        self.made = MADE

    DEF
        LINE
        self.get_logger().info('called')
        return RETURNED


def main():
    rclpy.init()
    rclpy.spin(Adder())
    LAST


if __name__ == '__main__':
    main()
"""
MADE = {
    "service": "self.create_service(AddTwoInts, 'add', self.done)",
    "subscription": "self.create_subscription(String, 'chat', self.done, 10)",
    "action": "ActionServer(self, Fibonacci, 'fib', self.done)",
    "named": "ActionServer(self, Fibonacci, 'fib', execute_callback=self.done)",
}


def told(
    folder: Path, kind: str, head: str, line: str, *, returned: str = "Fibonacci.Result()", last: str = "pass"
) -> list[tuple[str, str]]:
    words = {"MADE": MADE[kind], "DEF": head, "LINE": line, "RETURNED": returned, "LAST": last}
    text = TEXT
    for word, value in words.items():
        text = text.replace(word, value)
    codes = ("callback-arguments", "name-undefined")
    return [(f.code, f.fix) for f in source_faults(sources_of(text, folder)) if f.code in codes]


@pytest.mark.parametrize(
    ("kind", "head", "line", "fix"),
    [
        ("service", "def done(self, request):", "response.sum = request.a", "self, request, response"),
        ("service", "def done(self):", "response.sum = request.a", "self, request, response"),
        ("service", "def done(self):", "out.sum = given.a", "self, given, out"),
        ("service", "def done(self, req):", "response.sum = req.a", "self, req, response"),
        ("service", "def done(self, req):", "out.sum = req.a", "self, req, out"),
        ("subscription", "def done(self):", "print(msg.data)", "self, msg"),
        ("subscription", "def done(self):", "print(message.data)", "self, message"),
        ("action", "def done(self):", "goal_handle.succeed()", "self, goal_handle"),
        ("action", "def done(self):", "pass", "self, goal_handle"),
        ("action", "def done(self):", "goal.succeed()", "self, goal"),
        ("named", "async def done(self):", "goal_handle.succeed()", "self, goal_handle"),
    ],
)  # fmt: skip
def test_what_a_def_lacks_is_told_once(tmp_path: Path, kind: str, head: str, line: str, fix: str) -> None:
    returned = {"service": "response", "action": "Fibonacci.Result()"}.get(kind, "None")
    returned = "out" if "out." in line else returned
    word = head.partition(" done")[0]
    assert told(tmp_path, kind, head, line, returned=returned) == [
        ("callback-arguments", f"write {word} done({fix}):")
    ]


@pytest.mark.parametrize(
    ("kind", "head", "line"),
    [
        ("action", "def done(self, goal_handle):", "goal_handle.succeed()"),
        ("action", "def done(self, goal, *rest):", "goal.succeed()"),
        ("action", "def done(self, *given):", "print(given)"),
        ("named", "async def done(self, handle, more=None):", "print(handle, more)"),
        ("subscription", "def done(self, msg, info):", "print(msg, info)"),
    ],
)
def test_a_def_that_takes_what_it_is_called_with_is_right(
    tmp_path: Path, kind: str, head: str, line: str
) -> None:
    assert told(tmp_path, kind, head, line) == []


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("stray", "remove this line"),
        ("stray.more", "remove this line"),
        ("shutdown", "write `rclpy.shutdown()`"),
        ("x = stray + 1", "write a line above it that gives stray its value"),
        ("if rclpy.ok():\n        stray", "write `pass` instead of this line"),
    ],
)
def test_a_word_alone_on_its_line_is_removed(tmp_path: Path, line: str, fix: str) -> None:
    head = "def done(self, goal_handle):"
    assert told(tmp_path, "action", head, "pass", last=line) == [("name-undefined", fix)]


@pytest.mark.parametrize(
    ("kind", "line", "right"),
    [
        ("action", "print(vel * 2)", "self, goal_handle"),
        ("subscription", "print(speed * 2)", "self, msg"),
        ("service", "print(first, second)", "self, request, response"),
    ],
)
def test_a_number_of_the_body_is_not_what_a_callback_is_called_with(
    tmp_path: Path, kind: str, line: str, right: str
) -> None:
    found = told(tmp_path, kind, "def done(self):", line)
    assert found[0] == ("callback-arguments", f"write def done({right}):") or found[-1] == (
        "callback-arguments",
        f"write def done({right}):",
    )
    assert "name-undefined" in [code for code, _ in found]


def test_another_name_that_a_callback_lacks_is_told_too(tmp_path: Path) -> None:
    line = "response.sum = request.a + stray + more"
    found = told(tmp_path, "service", "def done(self, request):", line, returned="response")
    assert sorted(code for code, _ in found) == ["callback-arguments", *["name-undefined"] * 2]


@pytest.mark.parametrize(
    ("line", "returned", "fix"),
    [
        ("goal.fail()", "Fibonacci.Result()", "write one of its methods: succeed(), abort() and canceled() end a goal"),
        ("goal.suceed()", "Fibonacci.Result()", "write goal.succeed"),
        ("print(goal.requets)", "Fibonacci.Result()", "write goal.request"),
        ("goal.succeed()", "0", "write `return Fibonacci.Result()` instead of what line 19 returns"),
        ("goal.succeed()", "None", "write `return Fibonacci.Result()` instead of what line 19 returns"),
        ("goal.canceled()", "self.made", ""),
        ("goal.count = 1; print(goal.count)", "Fibonacci.Result()", ""),
        ("goal = goal.request; print(goal.order)", "Fibonacci.Result()", ""),
        ("print(goal.goal_id, goal.is_active, goal.status)", "Fibonacci.Result()", ""),
    ],
)  # fmt: skip
def test_what_an_execute_callback_does_with_its_goal(
    tmp_path: Path, line: str, returned: str, fix: str
) -> None:
    text = (
        TEXT.replace("MADE", MADE["action"]).replace("DEF", "def done(self, goal):").replace("LAST", "pass")
    )
    text = text.replace("LINE", line).replace("RETURNED", returned)
    found = source_faults(sources_of(text, tmp_path))
    codes = ("callback-arguments", "attribute-missing")
    assert [finding.fix for finding in found if finding.code in codes] == [fix] * bool(fix)
