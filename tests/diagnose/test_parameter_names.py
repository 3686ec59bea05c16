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


DEEP = "    drive:\n      speed: 0.3\n"


@pytest.mark.parametrize(
    ("given", "declared", "expected"),
    [
        (DEEP, "declare_parameter('drive/speed', 0.5)", (4, "write 'drive.speed' instead of 'drive/speed' where the node declares and reads it")),
        (DEEP, "declare_parameter('drive_speed', 0.5)", (4, "write 'drive.speed' instead of 'drive_speed' where")),
        ("    drive/speed: 0.3\n", "declare_parameter('drive.speed', 0.5)", (3, "write drive.speed instead of drive/speed")),
        ("    drive_speed: 0.3\n", "declare_parameter('drive.speed', 0.5)", (3, "write drive.speed instead of drive_speed")),
        (GIVEN, "declare_parameters('drive', [('speed', 0.5)])", (3, "write drive.speed instead of speed")),
        (DEEP, "declare_parameters('', [('speed', 0.5)])", (4, "write speed instead of drive.speed")),
        (DEEP, "declare_parameters('', [('speed', 'fast')])", (4, "write speed instead of drive.speed, with a text as its value")),
        ("    robot:\n      drive: {speed: 0.3}\n", "declare_parameter('drive.speed', 0.5)", (4, "write drive.speed instead of robot.drive.speed")),
        ("    left: {speed: 0.3}\n", "declare_parameter('lift.speed', 0.5)", (3, "write lift.speed instead of left.speed, or declare it")),
        ("    robot: {sped: 0.3}\n", "declare_parameter('robot.speed', 0.5)", (3, "write robot.speed instead of robot.sped")),
        (DEEP, "declare_parameter('drive.speed', 0.5)", (4, "")),
        (DEEP, "declare_parameters('drive', [('speed', 0.5)])", (4, "")),
        ("    drive.speed: 0.3\n", "declare_parameter('drive.speed', 0.5)", (3, "")),
        (f"{DEEP}    drive_speed: 0.3\n", "declare_parameters('', [('drive_speed', 0.5), ('drive.speed', 0.5)])", (3, "")),
        ("    wheel: {kp: 0.3, kd: 0.1}\n", "declare_parameters('wheel', [('kp', 0.5), ('kd', 0.5)])", (3, "")),
    ],
)  # fmt: skip
@pytest.mark.parametrize("section", ["velocity_publisher", "/**"])
def test_the_parts_of_a_name_are_joined_otherwise(
    tmp_path: Path, section: str, given: str, declared: str, expected: tuple[int, str]
) -> None:
    line, fix = expected
    files = changed(
        [
            (FILE, GIVEN, given),
            (FILE, "velocity_publisher", section),
            ("driver", DECLARED, f"self.{declared}"),
        ]
    )
    files.change("driver", "self.get_parameter('speed').value", "0.5")
    found = found_in(files, tmp_path)
    assert [(one.place.rpartition(":")[2], fix in one.fix) for one in found] == [(str(line), True)] * bool(
        fix
    )


def test_two_of_one_name_that_the_node_has_once(tmp_path: Path) -> None:
    found = found_in(changed([(FILE, GIVEN, "    left: {speed: 0.3}\n    right: {speed: 0.4}\n")]), tmp_path)
    assert ["declare it: self.declare_parameter" in one.fix for one in found] == [True, True]


@pytest.mark.parametrize(
    ("given", "fix"),
    [
        ("{'velocity_publisher': {'ros__parameters': {'speed': 1.0}}}", "write parameters=[{'speed': 1.0}]"),
        ("{'ros__parameters': {'speed': 1.0}}", "write parameters=[{'speed': 1.0}]"),
        ("{'/**': {'ros__parameters': {'speed': 1.0}}}", "write parameters=[{'speed': 1.0}]"),
        ("{'velocity_publisher': {'ros__parameters': {'drive': {'speed': 1.0}}}}", "write parameters=[{'drive.speed': 1.0}]"),
        ("{'other': {'ros__parameters': {'period': 2.0}}, 'velocity_publisher': {'ros__parameters': {'speed': 1.0}}}", "write parameters=[{'speed': 1.0}]"),
        ("{'velocity_publisher': {'ros__parameters': {'speed': 2.0 / 2.0}}}", "give speed directly, without the levels above it"),
        ("__import__('yaml').safe_load('velocity_publisher: {ros__parameters: {speed: 1.0}}')", "give the path of the file itself"),
        ("{'velocity_publisher': {'speed': 1.0}}", "write speed instead of velocity_publisher.speed"),
        ("{'speed': 1.0}", ""),
    ],
)  # fmt: skip
def test_a_dictionary_with_the_levels_of_a_file(tmp_path: Path, given: str, fix: str) -> None:
    found = found_in(changed([(LAUNCH, "[config]", f"[config, {given}]")]), tmp_path)
    assert [one.fix.startswith(fix) and "declare" not in one.fix for one in found] == [True] * bool(fix)


@pytest.mark.parametrize(
    ("given", "default", "expected"),
    [
        ("speed: 010", "5", ("parameter-octal", "write speed: 10, without")),
        ("speed: -0012  # m", "5", ("parameter-octal", "write speed: -12, without")),
        ("speed: [007, 010]", "[1, 2]", ("parameter-octal", "write speed: [7, 10], without")),
        ("drive: {speed: 010}", "5", ("parameter-octal", "write drive.speed: 10, without")),
        ("speed: 08", "5", ("parameter-type", "write speed: 8, a whole number")),
        ("speed: 1e3", "5", ("parameter-type", "write speed: 1000, a whole number")),
        ("speed: 1_000", "5", ("parameter-type", "write speed: 1000, a whole number")),
        ("speed: 1_000.5", "5.0", ("parameter-type", "write speed: 1000.5, without")),
        ("speed: 1.10", "'1.2'", ("parameter-type", "put it in quotes")),
        ("speed: on", "'off'", ("parameter-type", "put it in quotes")),
        ("speed: 010", "0o17", ("", "")),
        ("speed: 007", "5", ("", "")),
        ("speed: 0x1F", "5", ("", "")),
        ("speed: '010'", "'5'", ("", "")),
        ("speed: 12:30", "'5'", ("", "")),
        ("speed: 1e3", "5.0", ("", "")),
    ],
)
@pytest.mark.parametrize("section", ["velocity_publisher", "/**"])
def test_a_value_that_is_not_read_as_it_is_written(
    tmp_path: Path, section: str, given: str, default: str, expected: tuple[str, str]
) -> None:
    code, fix = expected
    name = "drive.speed" if "drive" in given else "speed"
    files = changed(
        [(FILE, "speed: 0.3", given), ("driver", DECLARED, f"self.declare_parameter('{name}', {default})")]
    )
    files.change("driver", "self.get_parameter('speed').value", "0.5")
    if code != "parameter-type":
        files.change(FILE, "velocity_publisher", section)
    found = [
        one for one in Look(files.write(tmp_path), loads=True).findings if one.code.startswith("parameter-")
    ]
    assert [(one.code, one.fix.startswith(fix)) for one in found] == [(code, True)] * bool(code)


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
