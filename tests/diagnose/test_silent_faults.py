"""What no error tells: found by reading, one row a mistake."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_text
from ros2lab.diagnose.look import Look

ROWS = [
    ("node", "self.count += 1", "self.count =+ 1", "no-effect", "+="),
    ("node", "f'Robot is", "'Robot is", "text-not-filled", "f'"),
    ("node", "self.publisher_.publish(msg)", "self.publisher_.publish", "no-effect", "publish(msg)"),
    ("node", "create_timer(0.5", "create_timer(500", "period", "0.5"),
    ("node", "self.count += 1", "count = 7", "not-kept", "self.count"),
    ("node", "        msg = String()", "        return\n        msg = String()", "unreachable", "return"),
    ("node", "    try:\n        rclpy.spin", "    node.destroy_node()\n    try:\n        rclpy.spin", "life-order", "after"),
    ("listener", "msg.data == 'start'", "msg.data.lower() == 'Start'", "no-effect", "'start'"),
    ("listener", "__init__('command_subscriber')", "__init__('status_publisher')", "name-twice", "another name"),
    ("driver", "msg.linear.x = self.get_parameter('speed').value", "msg.linear.x = 0,2", "field-type", "0.2"),
    ("driver", "self.get_parameter('speed').value", "self.get_parameter('speed')", "field-type", ".value"),
    ("setup.py", "'console_scripts': [", "'console_script': [", "entry-points-key", "console_scripts"),
    ("launch/robot.launch.py", "parameters=[config]", "parameters={'speed': 0.3}", "launch-argument", "[{"),
    ("launch/robot.launch.py", "'config', 'robot.yaml'", "'/config', 'robot.yaml'", "path-absolute", "'config'"),
]  # fmt: skip


@pytest.mark.parametrize("row", ROWS)
def test_a_fault_that_nobody_reports_is_found_where_it_stands(
    tmp_path: Path, row: tuple[str, str, str, str, str]
) -> None:
    """Its code, its file, and a fix that says what to write."""
    file, old, new, code, fix = row
    files = right_workspace().change(file, old, new)
    findings = Look(files.write(tmp_path)).findings
    found = next((finding for finding in findings if finding.code == code), None)
    assert found is not None, findings
    assert files.path(file) in found.place
    assert fix in found.fix


@pytest.mark.parametrize(("first", "is_fault"), [("pass", True), ("self.timer.cancel()", False)])
def test_a_callback_that_ends_its_timer_may_make_what_is_made_once(
    tmp_path: Path, first: str, is_fault: bool
) -> None:
    made = f"        {first}\n        self.late = self.create_publisher(String, 'late', 10)\n        msg = String()"
    files = right_workspace().change("node", "        msg = String()", made)
    codes = [finding.code for finding in Look(files.write(tmp_path)).findings]
    assert ("made-again" in codes) is is_fault


@pytest.mark.parametrize(
    ("made", "other", "is_lost"),
    [
        ("self.late = PUB\n        self.late.publish(String())", "pass", True),
        ("self.create_publisher(String, 'late', 10).publish(String())", "pass", True),
        ("self.late = PUB", "self.late.publish(String())", False),
        ("self.late = PUB\n        self.late.publish(String())", "self.late.publish(String())", False),
        ("late = PUB\n        while late.get_subscription_count() == 0:\n            pass\n        late.publish(String())", "pass", False),
    ],
)  # fmt: skip
def test_only_what_is_sent_by_the_call_that_makes_its_publisher_is_lost(
    tmp_path: Path, made: str, other: str, is_lost: bool
) -> None:
    made = made.replace("PUB", "self.create_publisher(String, 'late', 10)")
    files = right_workspace().change(
        "node", "        msg = String()", f"        {made}\n        msg = String()"
    )
    files.change(
        "node", "    def timer_callback", f"    def other(self):\n        {other}\n\n    def timer_callback"
    )
    (found,) = (f for f in Look(files.write(tmp_path)).findings if f.code == "made-again")
    assert ("no subscriber is connected yet" in found.cause) is is_lost


@pytest.mark.parametrize(
    ("typed", "said", "fix"),
    [
        ("ros2 run status_publisher", "ros2 run: error: the following arguments are required: executable_name", "ros2 run my_bot status_publisher"),
        ("ros2 run my_bot velocity_publisher -p speed:=1.0", "", "--ros-args -p speed:=1.0"),
        ("ros2 topic echo /robot/reprt", "WARNING: topic [/robot/reprt] does not appear to be published yet", "ros2 topic echo /robot/report"),
        ("ros2 topic pub /robot/command std_msgs/msg/String '{data: Start}'", "", "'Start'"),
        ("ros2 param get /velocity_publisher sped", "Parameter not set", "speed"),
    ],
)  # fmt: skip
def test_what_was_typed_is_compared_with_the_workspace(
    tmp_path: Path, typed: str, said: str, fix: str
) -> None:
    root = right_workspace().write(tmp_path)
    assert fix in of_text(f"$ {typed}\n{said}\n", root)[0].fix
