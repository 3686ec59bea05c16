"""Parameters that are given to a node which does not declare them, of which ROS says nothing."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace
from workspace_files import Files

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look

FILE, LAUNCH = "config/robot.yaml", "launch/robot.launch.py"
GIVEN = "    speed: 0.3\n"
DECLARED = "self.declare_parameter('speed', 0.5)"
Changes = list[tuple[str, str, str]]


def found_in(files: Files, folder: Path) -> list[Finding]:
    look = Look(files.write(folder), loads=True)
    return [finding for finding in look.findings if finding.code == "parameter-name"]


def changed(changes: Changes) -> Files:
    files = right_workspace()
    for name, old, new in changes:
        files.change(name, old, new)
    return files


@pytest.mark.parametrize(
    ("changes", "line", "fix"),
    [
        ([(FILE, "speed", "max_speed")], 3, "write speed instead of max_speed, or declare it: self.declare_parameter('max_speed', 0.3)"),
        ([(FILE, GIVEN, f"{GIVEN}    turn: 1.0\n")], 4, "declare it: self.declare_parameter('turn', 1.0)"),
        ([(FILE, GIVEN, f"{GIVEN}    max_speed: 1.0\n")], 4, "declare it: self.declare_parameter('max_speed', 1.0)"),
        ([(FILE, GIVEN, f"{GIVEN}    speeed: 1.0\n")], 4, "remove speeed, and keep the right value as speed"),
        ([(FILE, GIVEN, f"{GIVEN}    wheel:\n      radius: 1.0\n")], 5, "'wheel.radius', 1.0"),
        ([(FILE, "velocity_publisher:", "/**:"), (FILE, GIVEN, f"{GIVEN}    turn: 1.0\n")], 4, "'turn'"),
        ([(FILE, GIVEN, f"{GIVEN}status_publisher:\n  ros__parameters:\n    speed: 1.0\n"), ("node", "        self.count = 0", "        self.count = self.declare_parameter('first', 0).value")], 6, "declare it: self.declare_parameter('speed', 1.0)"),
        ([("driver", DECLARED, "self.declare_parameter('rate', 0.5)"), ("driver", "get_parameter('speed')", "get_parameter('rate')")], 3, "'speed', 0.3"),
    ],
)  # fmt: skip
def test_a_file_gives_what_the_node_does_not_declare(
    tmp_path: Path, changes: Changes, line: int, fix: str
) -> None:
    (found,) = found_in(changed(changes), tmp_path)
    assert found.place.endswith(f"robot.yaml:{line}")
    assert fix in found.fix


def test_the_launch_file_gives_what_the_node_does_not_declare(tmp_path: Path) -> None:
    (found,) = found_in(changed([(LAUNCH, "[config]", "[config, {'max_speed': 1.0}]")]), tmp_path)
    assert "robot.launch.py" in found.place
    assert "velocity_publisher declares speed" in found.cause
    assert "write speed instead of max_speed" in found.fix


def test_the_launch_file_gives_a_parameter_under_both_spellings(tmp_path: Path) -> None:
    (found,) = found_in(changed([(LAUNCH, "[config]", "[config, {'speed': 1.0, 'sped': 2.0}]")]), tmp_path)
    assert found.fix.startswith("remove sped, and keep the right value as speed, which is there as well")


@pytest.mark.parametrize(
    ("given", "fix"),
    [
        ("[config, {'speed': 1}]", "write 1.0 instead of 1"),
        ("[config, {'speed': True}]", "write a number with a decimal point instead of True"),
        ("[config, {'speed': [1.0]}]", "write a number with a decimal point instead of [1.0]"),
        ("[config, {'speed': 1.0}]", ""),
        ("[{'speed': 1}, config]", ""),
        ("[config, {'speed': '1.0'}]", ""),
        ("[{'use_sim_time': False}]", ""),
    ],
)
def test_the_launch_file_gives_a_value_of_another_type(tmp_path: Path, given: str, fix: str) -> None:
    look = Look(changed([(LAUNCH, "[config]", given)]).write(tmp_path), loads=True)
    told = [finding for finding in look.findings if finding.code == "parameter-type"]
    assert [finding.fix for finding in told] == [fix] * bool(fix)


@pytest.mark.parametrize(
    "changes",
    [
        [],
        [(FILE, GIVEN, f"{GIVEN}    use_sim_time: false\n    qos_overrides:\n      /cmd_vel:\n        publisher:\n          depth: 1\n")],
        [(FILE, GIVEN, f"{GIVEN}    turn: 1.0\n"), ("driver", DECLARED, f"{DECLARED}\n        for name in ('turn',):\n            self.declare_parameter(name, 1.0)")],
        [(FILE, GIVEN, f"{GIVEN}    turn: 1.0\n"), ("driver", DECLARED, f"{DECLARED}\n        more = self.declare_parameter\n        more('turning'[:4], 1.0)")],
        [(FILE, GIVEN, f"{GIVEN}    turn: 1.0\n"), ("driver", "('velocity_publisher')", "('velocity_publisher', allow_undeclared_parameters=True)")],
        [(FILE, GIVEN, f"{GIVEN}    turn: 1.0\n"), ("driver", "import rclpy\n", "import their_robot.parameters\nimport rclpy\n"), ("driver", DECLARED, f"{DECLARED}\n        their_robot.parameters.declare(self)")],
        [(FILE, GIVEN, f"{GIVEN}    turn: 1.0\n"), ("driver", "import rclpy\n", "from their_robot.mixins import Turning\nimport rclpy\n"), ("driver", "(Node)", "(Turning, Node)")],
        [(FILE, "velocity_publisher:", "/**:"), (LAUNCH, "'status_publisher')", "'status_publisher', parameters=[config])")],
        [(FILE, "velocity_publisher:", "/**:"), (FILE, GIVEN, f"{GIVEN}    turn: 1.0\n"), (LAUNCH, "'status_publisher')", "'status_publisher'),\n        Node(package='turtlesim', executable='turtlesim_node', parameters=[config])")],
        [(FILE, GIVEN, f"{GIVEN}status_publisher:\n  ros__parameters:\n    period: 1.0\n")],
        [(FILE, GIVEN, f"{GIVEN}turtlesim:\n  ros__parameters:\n    background_r: 1\n")],
        [(LAUNCH, "[config]", "[{'speed': 1.0}]"), (LAUNCH, "'status_publisher')", "'status_publisher', parameters=[{'speed': 1.0}])")],
    ],
)  # fmt: skip
def test_what_may_be_declared_is_not_told(tmp_path: Path, changes: Changes) -> None:
    assert not found_in(changed(changes), tmp_path)


def test_a_node_declares_what_the_class_that_it_is_made_from_does_not(tmp_path: Path) -> None:
    """The second class has its name from the first one, in another file."""
    sub = "from my_bot.velocity_publisher import VelocityPublisher\n\n\nclass Turning(VelocityPublisher):\n    def __init__(self):\n        super().__init__()\n        self.declare_parameter('turn', 1.0)\n        self.get_logger().info(str(self.get_parameter('turn').value))\n"
    files = changed([(FILE, GIVEN, f"{GIVEN}    turn: 1.0\n")])
    assert found_in(files, tmp_path / "without")
    assert not found_in(files.put("my_bot/turning.py", sub), tmp_path / "with")
