"""Exceptions that the student's own code raises in a callback: what they end, and what to write instead."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from one_file import printed_by
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text

HEAD = """\
import rclpy
from functools import partial
from rclpy.action import ActionServer, GoalResponse
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger
from example_interfaces.srv import AddTwoInts
from example_interfaces.action import Fibonacci


class Full(Exception):
    pass


class Door(Node):
    def __init__(self):
        super().__init__('door')
        self.level = 3
        MAKES

"""
RUN = """

def main():
    rclpy.init()
    node = Door()
    STARTS
    rclpy.spin(node)


if __name__ == '__main__':
    main()
"""
RCLPY = (
    '  File "/opt/ros/jazzy/lib/python3.12/site-packages/rclpy/executors.py", line 111, in await_or_execute\n'
)
SERVE = "self.create_service(SetBool, 'set', self.go)"
GO = "    def go(self, request, response):\n"


def written(makes: str, methods: str, starts: str = "pass") -> str:
    return HEAD.replace("MAKES", makes) + methods + RUN.replace("STARTS", starts)


def told(root: Path, code: str, *called: str, through: str = RCLPY) -> Finding:
    """Return what is told of an error of the last of some lines, each in a function that the one before calls."""
    files = Files.right(NAMES[1])
    files.put("PACKAGE/door.py", code)
    path = files.write(root) / files.path("PACKAGE/door.py")
    lines = code.splitlines()
    numbers = [next(n for n, line in enumerate(lines, 1) if text in line) for text in called]
    frames = [f'  File "{path}", line {n}, in f\n    {lines[n - 1].strip()}\n' for n in numbers]
    kind = re.search(r"raise (\w+)", lines[numbers[-1] - 1])
    error = f"{kind[1] if kind else 'AssertionError'}: it is full\n"
    text = f"Traceback (most recent call last):\n{through}{''.join(frames)}{error}"
    return of_text(text, root)[0]


@pytest.mark.parametrize(
    ("makes", "methods", "called", "fix"),
    [
        (SERVE, GO + "        raise ValueError('full')\n", ["raise"],
         "write `response.success = False`, `response.message = 'full'` and `return response` instead of the raise"),
        ("self.create_service(Trigger, 'go', lambda req, res: self.go(req, res))",
         GO + "        raise Full(f'full: {self.level}')\n", ["lambda req", "raise"],
         "`response.success = False`, `response.message = f'full: {self.level}'` and `return response`"),
        ("self.create_service(AddTwoInts, 'go', self.go)", GO + "        raise ValueError(request.a)\n", ["raise"],
         "`self.get_logger().warning(str(request.a))` and `return response`"),
        (SERVE, GO + "        assert request.data, 'no'\n", ["assert"],
         "write `if not request.data:` instead of the assert, and, indented below it, `response.success = False`, `response.message = 'no'`"),
        (SERVE, GO + "        self.check()\n\n    def check(self):\n        raise Full('full')\n", ["self.check()", "raise"],
         "`try:`, and write `except Full as error:` after it, with `response.success = False`, `response.message = str(error)` and `return response`"),
        (SERVE, GO + "        raise Full(\n            'it is '\n            'full')\n", ["raise"],
         "`response.message = 'it is full'` and `return response` instead of the raise"),
        (SERVE, GO + "        if self.check():\n            response.success = True\n        return response\n\n"
         "    def check(self):\n        raise Full('full')\n", ["if self.check()", "raise"],
         "in go(), indent lines 23 to 24 below a `try:`"),
        ("self.create_timer(1.0, self.tick)", "    def tick(self):\n        raise RuntimeError('late')\n", ["raise"],
         "`self.get_logger().warning('late')` and `return`"),
        ("self.create_subscription(String, 'in', partial(self.take, 3), 10)",
         "    def take(self, most, msg):\n        raise ValueError\n", ["raise"], "and `return` instead of the raise"),
        ("self.add_on_set_parameters_callback(self.check)",
         "    def check(self, params):\n        raise ValueError('no ' + params[0].name)\n", ["raise"],
         "`return SetParametersResult(successful=False, reason='no ' + params[0].name)` instead of the raise, with `from rcl_interfaces.msg import SetParametersResult`"),
        ("self.server = ActionServer(self, Fibonacci, 'f', self.run)",
         "    def run(self, goal_handle):\n        raise RuntimeError('stuck')\n", ["raise"],
         "`self.get_logger().warning('stuck')`, `goal_handle.abort()` and `return Fibonacci.Result()`"),
        ("self.server = ActionServer(self, Fibonacci, 'f', self.run, goal_callback=self.may)",
         "    def may(self, goal):\n        raise RuntimeError('no')\n", ["raise"],
         "`return GoalResponse.REJECT` instead of the raise"),
        ("self.client.call_async(SetBool.Request()).add_done_callback(self.done)",
         "    def done(self, future):\n        raise RuntimeError('no')\n", ["raise"],
         "`self.get_logger().warning('no')` and `return`"),
    ],
)  # fmt: skip
def test_what_to_write_instead_of_a_raise_is_told(
    tmp_path: Path, makes: str, methods: str, called: list[str], fix: str
) -> None:
    """In words of the callback's own kind, with its own names, and as Python that can be read."""
    code = written(makes, methods)
    found = told(tmp_path, code, *called)
    assert found.code == "raise-in-callback"
    assert "door.py:" in found.place
    assert fix in found.fix
    for statement in re.findall(r"`([^`]+)`", found.fix):
        if not statement.endswith(":"):
            ast.parse(statement)


@pytest.mark.parametrize(
    ("makes", "methods", "called", "through"),
    [
        ("self.check()", "    def check(self):\n        raise ValueError('low')\n", ["self.check()", "raise"], ""),
        (SERVE, GO + "        raise NotImplementedError\n", ["raise"], RCLPY),
        (SERVE, GO + "        int('full')\n", ["int("], RCLPY),
    ],
)  # fmt: skip
def test_what_is_no_refusal_in_a_callback_is_told_otherwise(
    tmp_path: Path, makes: str, methods: str, called: list[str], through: str
) -> None:
    """An exception in a constructor, a method that is not written yet, and what a library raises."""
    assert told(tmp_path, written(makes, methods), *called, through=through).code != "raise-in-callback"


def test_a_real_service_answers_after_the_fix(tmp_path: Path) -> None:
    """As rclpy prints the error, and as a caller sees the response."""
    asks = (
        "client = node.create_client(SetBool, 'set')\n    future = client.call_async(SetBool.Request())\n"
        "    rclpy.spin_until_future_complete(node, future, timeout_sec=30.0)\n    print(future.result())\n    return"
    )
    code = written(SERVE, GO + "        raise ValueError('it is full')\n", asks)
    code = code.replace("from example_interfaces.srv import AddTwoInts\n", "").replace(
        "from example_interfaces.action import Fibonacci\n", ""
    )
    files = Files.right(NAMES[1])
    files.put("PACKAGE/door.py", code)
    path = files.write(tmp_path) / files.path("PACKAGE/door.py")
    found = of_text(printed_by(path), tmp_path)[0]
    assert found.code == "raise-in-callback"
    statements = re.findall(r"`([^`]+)`", found.fix)
    path.write_text(code.replace("raise ValueError('it is full')", "\n        ".join(statements)))
    assert "success=False, message='it is full'" in printed_by(path)
