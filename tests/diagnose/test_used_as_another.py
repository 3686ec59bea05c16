"""Objects that are used as another kind of thing, which they lead to: elements by name, times, and futures."""

from __future__ import annotations

from pathlib import Path

import pytest

from ros2lab.diagnose import of_text
from ros2lab.diagnose.causes.python_says import of_error
from ros2lab.diagnose.checking.later_results import of_future
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.python_source import read_source

NODE = """\
import time
from concurrent.futures import ThreadPoolExecutor

from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Path
from rclpy.action import ActionClient
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint


class Arm(Node):
    def __init__(self):
        super().__init__('arm')
        self.last = self.last_stamp = None
        self.client = self.create_client(Trigger, 'go')
        self.create_subscription(JointState, 'a', self.joints, 10)
        self.create_subscription(DiagnosticArray, 'b', self.status, 10)
        self.create_subscription(Path, 'c', self.path, 10)
        self.create_subscription(JointTrajectory, 'd', self.way, 10)
        self.create_subscription(JointTrajectoryPoint, 'e', self.point, 10)
        self.add_on_set_parameters_callback(self.params)  # create_sub, too: .params,

    def METHOD(self, msg):
        now = self.get_clock().now()
        BODY
"""


def spot_of(root: Path, method: str, body: str) -> Spot:
    lines = NODE.replace("METHOD", method).replace("BODY", body).splitlines(keepends=True)
    text = "".join(line for line in lines if "create_sub" not in line or f".{method}," in line)
    path = root / "arm.py"
    path.write_text(text)
    return Spot(read_source(path, "arm", "arm.py"), text.count("\n"))


@pytest.mark.parametrize(
    ("method", "body", "fix"),
    [
        ("joints", "v = msg.velocity['left']", "write `msg.velocity[msg.name.index('left')]` instead of"),
        ("status", "s = msg.status['a']", "write `next(item for item in msg.status if item.name == 'a')`"),
        ("params", "p = msg['speed']", "write `next(item for item in msg if item.name == 'speed')`"),
        ("path", "p = msg.poses['goal']", "print msg.poses just above this line"),
        ("way", "p = msg.points['elbow']", "print msg.points just above this line"),
        ("params", "p = [1, 2]['a']", "print [1, 2] just above this line"),
        ("joints", "v = msg.position[len(msg.position) / 2]", "use a whole number there"),
    ],
)
def test_an_element_is_found_by_what_names_it(tmp_path: Path, method: str, body: str, fix: str) -> None:
    found = of_error(
        "TypeError", "array indices must be integers", "arm.py:1", spot_of(tmp_path, method, body)
    )
    assert found is not None
    assert found.fix.startswith(fix)


@pytest.mark.parametrize(
    ("method", "body", "kinds", "written"),
    [
        ("joints", "d = now - msg.header.stamp", "TT", "now - Time.from_msg(msg.header.stamp)"),
        ("joints", "d = now > msg.header.stamp", "TT", "now > Time.from_msg(msg.header.stamp)"),
        ("point", "d = now + msg.time_from_start", "TD", "now + Duration.from_msg(msg.time_from_start)"),
        ("joints", "d = now - self.last_stamp", "TT", "now - Time.from_msg(self.last_stamp)"),
        (
            "joints",
            "d = msg.header.stamp - self.last.header.stamp",
            "TT",
            "Time.from_msg(msg.header.stamp) - Time.from_msg(self.last.header.stamp)",
        ),
        (
            "joints",
            "d = msg.header.stamp - time.time()",
            "Tf",
            "Time.from_msg(msg.header.stamp).nanoseconds / 1e9 - time.time()",
        ),
        ("joints", "d = now - 5.0", "Tf", "now - Duration(seconds=5.0)"),
    ],
)
def test_a_time_of_a_message_becomes_one_of_rclpy(
    tmp_path: Path, method: str, body: str, kinds: str, written: str
) -> None:
    names = {"T": "Time", "D": "Duration", "f": "float"}
    sign = body.split()[3]
    types = [f"'{names[letter]}'" for letter in kinds]
    said = f"unsupported operand type(s) for {sign}: {' and '.join(types)}"
    if sign == ">":
        said = f"'>' not supported between instances of {' and '.join(types)}"
    found = of_error("TypeError", said, "arm.py:1", spot_of(tmp_path, method, body))
    assert found is not None
    assert found.fix.startswith(f"write `{written}`, with `from rclpy.")
    assert ("is a message" in found.cause or "them is a message" in found.cause) is ("from_msg" in written)


@pytest.mark.parametrize(
    ("method", "body", "name", "fix"),
    [
        (
            "run",
            "answer = self.client.call_async(Trigger.Request())\n        print(answer.success)",
            "success",
            "write three lines instead of line LINE: `future = self.client.call_async(Trigger.Request())`, "
            "`rclpy.spin_until_future_complete(self, future)` and `answer = future.result()`",
        ),
        (
            "run",
            "print(self.client.call_async(Trigger.Request()).success)",
            "success",
            "write `future = self.client.call_async(Trigger.Request())` and "
            "`rclpy.spin_until_future_complete(self, future)` above line LINE, and `future.result()` there instead",
        ),
        (
            "joints",
            "answer = self.client.call_async(Trigger.Request())\n        print(answer.success)",
            "success",
            "write `future = self.client.call_async(Trigger.Request())` and `future.add_done_callback(self.answered)`",
        ),
        ("run", "print(msg.success)", "success", "write `msg.result().success` instead of `msg.success`"),
        (
            "run",
            "handle = ActionClient(self, Trigger, 'go').send_goal_async(1)\n        print(handle.accepted)",
            "accepted",
            "write three lines instead of line LINE",
        ),
        (
            "run",
            "value = ThreadPoolExecutor().submit(print)\n        print(value.data)",
            "data",
            "write `ThreadPoolExecutor().submit(print).result()` instead of `ThreadPoolExecutor().submit(print)`",
        ),
    ],
)
def test_a_future_is_not_yet_what_was_asked_for(
    tmp_path: Path, method: str, body: str, name: str, fix: str
) -> None:
    package = tmp_path / "src" / "arm"
    (package / "arm").mkdir(parents=True)
    (package / "arm" / "__init__.py").touch()
    (package / "package.xml").write_text("<package format='3'><name>arm</name></package>\n")
    (package / "setup.py").write_text("from setuptools import setup\n\nsetup(name='arm', packages=['arm'])\n")
    spot = spot_of(package / "arm", method, body)
    said = (
        f'Traceback (most recent call last):\n  File "{package}/arm/arm.py", line {spot.line}, in {method}\n'
        f"    {spot.text}\nAttributeError: 'Future' object has no attribute '{name}'\n"
    )
    found = of_text(said, tmp_path)[0]
    fix = fix.replace("LINE", str(spot.line - body.count("\n")))
    assert (found.code, found.fix[: len(fix)]) == ("attribute-missing", fix)


def test_what_a_node_has_is_not_asked_of_a_result(tmp_path: Path) -> None:
    spot = spot_of(tmp_path, "run", "msg.get_logger().info('done')")
    assert of_future("Future", "get_logger", spot, Look(tmp_path)) is None
