"""What rclpy lacks because a node has it: told with the student's own arguments, in the node's order."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text, of_workspace

NAME = NAMES[1]
COUNT = "        self.count = 0\n"
ROWS = [
    ("rclpy.Timer(rclpy.duration.Duration(seconds=0.5), self.tick)", "self.create_timer(0.5, self.tick)"),
    ("rclpy.Publisher('news', String, queue_size=5)", "self.create_publisher(String, 'news', 5)"),
    (
        "rclpy.Subscriber('news', String, self.tick)",
        "self.create_subscription(String, 'news', self.tick, 10)",
    ),
    ("rclpy.Service('reset', Trigger, self.tick)", "self.create_service(Trigger, 'reset', self.tick)"),
    ("rclpy.ServiceProxy('reset', Trigger)", "self.create_client(Trigger, 'reset')"),
    ("rclpy.Rate(10)", "self.create_rate(10)"),
    ("rclpy.Time.now()", "self.get_clock().now()"),
    ("rclpy.loginfo('hello')", "self.get_logger().info('hello')"),
    ("rclpy.get_param('speed')", "self.get_parameter('speed').value"),
    ("rclpy.get_param('speed', 3)", "self.declare_parameter('speed', 3).value"),
    ("rclpy.is_shutdown()", "not rclpy.ok()"),
    ("rclpy.sleep(1.0)", "time.sleep(1.0)"),  # for the file imports time
    ("rclpy.Duration(seconds=2)", "Duration(seconds=2)"),
]


@pytest.mark.parametrize(("call", "meant"), ROWS)
def test_the_call_is_told_as_the_node_has_it(tmp_path: Path, call: str, meant: str) -> None:
    files = Files.right(NAME).change("PACKAGE/MODULE.py", COUNT, f"        self.made = {call}\n{COUNT}")
    files = files.change(
        "PACKAGE/MODULE.py", "import rclpy\n", "import rclpy\nimport time\nfrom std_srvs.srv import Trigger\n"
    )
    path = files.path("PACKAGE/MODULE.py")
    line = next(n for n, text in enumerate(files.texts[path].splitlines(), 1) if "self.made" in text)
    name = call.removeprefix("rclpy.").partition("(")[0].partition(".")[0]
    text = (
        "$ ros2 run my_bot talker\nTraceback (most recent call last):\n"
        f'  File "{files.write(tmp_path) / path}", line {line}, in __init__\n    self.made = {call}\n'
        f"AttributeError: module 'rclpy' has no attribute '{name}'\n"
    )
    assert of_text(text, tmp_path)[0].fix.startswith(f"write `{meant}`")


@pytest.mark.parametrize(
    ("given", "fix"),
    [
        ("node", "write `self.node.create_rate(5)` instead of `rclpy.Rate(5)`"),
        ("speed", "hand a node to Helper, and write `node.create_rate(5)` on it instead of `rclpy.Rate(5)`"),
    ],
)
def test_a_class_that_is_no_node_asks_the_node_that_it_is_given(tmp_path: Path, given: str, fix: str) -> None:
    helper = f"""\
class Helper:
    def __init__(self, {given}):
        self.{given} = {given}
        print(self.{given}{".get_logger()" * (given == "node")})

    def go(self):
        self.rate = rclpy.Rate(5)


"""
    files = Files.right(NAME).change("node", "class CLASS", f"{helper}class CLASS")
    (found,) = of_workspace(files.write(tmp_path))
    assert found.fix == fix
