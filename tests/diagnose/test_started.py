"""What launch would start, what an entrance reaches, and slips that Python reads: each as an error that nobody reports."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_text
from ros2lab.diagnose.look import Look

LAUNCH = "launch/robot.launch.py"
STATUS = "Node(package='my_bot', executable='status_publisher')"
SPIN = "        rclpy.spin(node)"
Changes = list[tuple[str, str, str]]

STARTED: list[tuple[Changes, str, str]] = [
    ([(LAUNCH, "    return", f"    more = {STATUS}\n    return")], "launch-lost", "more"),
    (
        [(LAUNCH, "executable='velocity_publisher'", "executable='velocity_publisher', name='driver'")],
        "parameter-file-node",
        "/driver:",
    ),
    (
        [
            ("node", "'/robot/report'", "'news'"),
            ("listener", "'/robot/command'", "'news'"),
            (LAUNCH, STATUS, f"{STATUS[:-1]}, namespace='one')"),
        ],
        "launch-apart",
        "/one",
    ),
    (
        [
            ("listener", "'/robot/command'", "'/robot/report'"),
            (LAUNCH, STATUS, f"{STATUS[:-1]}, remappings=[('/robot/report', '/other')])"),
        ],
        "launch-apart",
        "remappings",
    ),
    ([(LAUNCH, "launch_ros.actions import Node", "launch.actions import ExecuteProcess as Node")], "import-wrong", "launch_ros.actions"),
]  # fmt: skip

REACHED: list[tuple[Changes, str, str]] = [
    ([("node", SPIN, "        rclpy.spin_once(node)")], "spin-missing", "rclpy.spin(node)"),
    (
        [("node", SPIN, "        executor = rclpy.executors.SingleThreadedExecutor()\n        executor.spin()")],
        "spin-missing",
        "executor.add_node(node)",
    ),
    ([("node", "def main(args=None):\n", "def main(args=None):\n    pass\n\n\ndef start(args=None):\n")], "never-made", "start()"),
    ([("setup.py", "my_bot.command_subscriber:main", "my_bot.status_publisher:main")], "entry-point-function", "my_bot.command_subscriber:main"),
    (
        [
            ("node", "def main(args=None):\n    rclpy.init(args=args)", "if __name__ == '__main__':\n    rclpy.init()"),
            ("node", "\n\nif __name__ == '__main__':\n    main()\n", "\n"),
        ],
        "entry-point-function",
        "def main(args=None):",
    ),
]  # fmt: skip

SLIPS: list[tuple[Changes, str, str]] = [
    ([("setup.py", "['package.xml']),", "['package.xml'])")], "setup-syntax", "comma"),
    (
        [("listener", "        self.state = 'idle'", "        self.state = 'idle'\n        self.words = [('a', 1) ('b', 2)]")],
        "comma-missing",
        "('a', 1)",
    ),
    (
        [("listener", "'/robot/command', self.command_callback", "self.command_callback, '/robot/command'")],
        "argument-order",
        "(String, '/robot/command', self.command_callback, 10)",
    ),
    (
        [("driver", "        self.timer", "        self.rate_hz = 10.0\n        self.timer"), ("driver", "timer(0.1,", "timer(self.rate_hz,")],
        "period",
        "1.0 / self.rate_hz",
    ),
    (
        [
            ("driver", "msg.linear.x = self.get_parameter('speed').value", "msg.linear.x = clamp(0.6, self.get_parameter('speed').value)"),
            ("driver", "class VelocityPublisher", "def clamp(speed, limit):\n    return min(speed, limit)\n\n\nclass VelocityPublisher"),
        ],
        "argument-order",
        "clamp(self.get_parameter('speed').value, 0.6)",
    ),
]  # fmt: skip


@pytest.mark.parametrize("row", [*STARTED, *REACHED, *SLIPS])
def test_what_nobody_reports_is_found_with_what_to_write(
    tmp_path: Path, row: tuple[Changes, str, str]
) -> None:
    """Its code, in the first file that was changed or in the parameter file, and a fix that says what to write."""
    changes, code, fix = row
    files = right_workspace()
    for file, old, new in changes:
        files.change(file, old, new)
    findings = Look(files.write(tmp_path), loads=True).findings
    found = next((finding for finding in findings if finding.code == code), None)
    assert found is not None, findings
    assert fix in found.fix
    assert any(
        files.path(file) in found.place for file in (*(change[0] for change in changes), "config/robot.yaml")
    )


RIGHT: list[Changes] = [
    # Two robots, of which each has both ends of its topic.
    [
        ("node", "'/robot/report'", "'news'"),
        ("listener", "'/robot/command'", "'news'"),
        (
            LAUNCH,
            STATUS,
            ", ".join(
                f"Node(package='my_bot', executable='{name}', namespace='{space}')"
                for space in ("one", "two")
                for name in ("status_publisher", "command_subscriber")
            ),
        ),
        (LAUNCH, "        Node(package='my_bot', executable='command_subscriber'),\n", ""),
    ],
    # A node that another one's end, or a condition, brings in.
    [
        (LAUNCH, "from launch import", "from launch.actions import TimerAction\nfrom launch.conditions import IfCondition\nfrom launch import"),
        (LAUNCH, STATUS, f"TimerAction(period=2.0, actions=[{STATUS}]), {STATUS[:-1]}, condition=IfCondition('false'))"),
    ],
    [("config/robot.yaml", "velocity_publisher:", "/**:"), (LAUNCH, "parameters=[config]", "name='driver', namespace='one', parameters=[config]")],
    [("node", SPIN, "        while rclpy.ok():\n            rclpy.spin_once(node)")],
    [("node", SPIN, "        executor = rclpy.executors.SingleThreadedExecutor()\n        executor.add_node(node)\n        executor.spin()")],
    [("driver", "        self.timer", "        self.rate = 0.1\n        self.timer"), ("driver", "timer(0.1,", "timer(self.rate,")],
]  # fmt: skip


@pytest.mark.parametrize("changes", RIGHT)
def test_what_is_unusual_and_right_raises_no_alarm(tmp_path: Path, changes: Changes) -> None:
    files = right_workspace()
    for file, old, new in changes:
        files.change(file, old, new)
    assert Look(files.write(tmp_path), loads=True).findings == []


def test_what_fails_is_followed_to_where_it_was_made(tmp_path: Path) -> None:
    """The error names the line in which a value is used; the comma stands where it was made."""
    made = "self.create_publisher(Twist, '/cmd_vel', 10)"
    files = right_workspace().change("driver", made, f"{made},")
    root = files.write(tmp_path)
    path = root / files.path("driver")
    number = path.read_text().splitlines().index("        self.publisher_.publish(msg)") + 1
    text = (
        f'Traceback (most recent call last):\n  File "{path}", line {number}, in timer_callback\n'
        "    self.publisher_.publish(msg)\nAttributeError: 'tuple' object has no attribute 'publish'\n"
    )
    assert of_text(text, root)[0].code == "comma-tuple"


def test_a_fix_that_changes_nothing_for_the_better_is_not_proposed(tmp_path: Path) -> None:
    """What is given rightly is not taken away to make a call fit."""
    files = right_workspace().change(LAUNCH, STATUS, f"{STATUS[:-1]}, condition='true')")
    root = files.write(tmp_path)
    text = (
        "$ ros2 launch my_bot robot.launch.py\n[ERROR] [launch]: Caught exception in launch (see debug for traceback): "
        "'str' object has no attribute 'evaluate'\n"
    )
    assert all(
        one.fix != "write `Node(package='my_bot', executable='status_publisher')`"
        for one in of_text(text, root)
    )
