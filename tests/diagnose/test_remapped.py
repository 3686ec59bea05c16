"""Remappings of launch files whose first name the node does not have."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace
from workspace_files import Files

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look

LAUNCH, DRIVER = "launch/robot.launch.py", "executable='velocity_publisher'"


def remapped(pair: str) -> Files:
    """Return a workspace whose launch file remaps a name of the node that publishes /cmd_vel."""
    return right_workspace().change(LAUNCH, DRIVER, f"{DRIVER}, remappings=[{pair}]")


def found_in(files: Files, folder: Path) -> list[Finding]:
    look = Look(files.write(folder), loads=True)
    return [finding for finding in look.findings if finding.code == "remap-unknown"]


@pytest.mark.parametrize(
    ("pair", "fix"),
    [
        ("('steering', '/cmd_vel')", "write ('/cmd_vel', 'steering') instead of ('steering', '/cmd_vel')"),
        ("('cmd_vell', 'steering')", "write 'cmd_vel' as the first name"),
        ("('wheels', 'steering')", "write 'cmd_vel' as the first name"),
        ("('/robot/report', 'steering')", "write 'cmd_vel' as the first name"),
    ],
)
def test_a_node_does_not_have_the_first_name(tmp_path: Path, pair: str, fix: str) -> None:
    (found,) = found_in(remapped(pair), tmp_path)
    assert "robot.launch.py" in found.place
    assert "first name must be the one in the code" in found.cause
    assert fix in found.fix


SPACE = "namespace='robot1'"


def inside(pair: str, space: str = f", {SPACE}") -> Files:
    """Return a workspace whose driver uses a relative name, in a namespace."""
    return (
        remapped(pair).change("driver", "'/cmd_vel'", "'cmd_vel'").change(LAUNCH, DRIVER, f"{DRIVER}{space}")
    )


@pytest.mark.parametrize(
    ("files", "wanted"),
    [
        (inside("('/cmd_vel', 'wheels')"), "write 'cmd_vel'"),
        (remapped("('cmd_vel', 'wheels')").change(LAUNCH, DRIVER, f"{DRIVER}, {SPACE}"), "write '/cmd_vel'"),
        (inside("('cmd_vel', 'wheels')"), ""),
        (inside("('/robot1/cmd_vel', 'wheels')"), ""),
        (remapped("('/cmd_vel', 'wheels')").change(LAUNCH, DRIVER, f"{DRIVER}, {SPACE}"), ""),
        (inside("('/cmd_vel', 'wheels')", ""), ""),
    ],
)
def test_a_slash_leaves_the_namespace(tmp_path: Path, files: Files, wanted: str) -> None:
    found = found_in(files, tmp_path)
    assert [one.fix.startswith(wanted) for one in found] == [True] * bool(wanted)


@pytest.mark.parametrize(
    ("first", "begin"),
    [("/robot/report", "write ('/cmd_vel',"), ("steering", "remove it if '/cmd_vel' is right")],
)
def test_which_way_round_a_remapping_is_meant_is_told_by_the_other_nodes(
    tmp_path: Path, first: str, begin: str
) -> None:
    (found,) = found_in(remapped(f"('{first}', '/cmd_vel')"), tmp_path)
    assert found.fix.startswith(begin)


@pytest.mark.parametrize(
    "files",
    [
        remapped("('/cmd_vel', 'steering')"),
        remapped("('cmd_vel', '/robot/cmd_vel')"),
        remapped("('/rosout', 'log')"),
        remapped("('/velocity_publisher/get_parameters', 'asked')"),
        remapped("('/robot/report', 'said')").change(LAUNCH, "'status_publisher')", "'status_publisher', remappings=[('/robot/report', 'said')])"),
        remapped("('~/state', 'state')"),
        remapped("('steering', '/cmd_vel')").change("driver", "'/cmd_vel'", "self.get_name()"),
        remapped("('tf', '/robot/tf')").change("driver", "import rclpy\n", "import rclpy\nimport tf2_ros\n").change("driver", "        self.timer =", "        self.sender = tf2_ros.TransformBroadcaster(self)\n        self.timer ="),
        remapped("('wheels', 'steering')").change("driver", "import rclpy\n", "import rclpy\nfrom their_robot.base import Wheels\n").change("driver", "(Node)", "(Wheels, Node)"),
        right_workspace().change(LAUNCH, "        Node(package='my_bot', executable='status", "        Node(package='turtlesim', executable='turtlesim_node', remappings=[('/turtle1/cmd_vel', '/cmd_vel')]),\n        Node(package='my_bot', executable='status"),
    ],
)  # fmt: skip
def test_what_a_node_may_have_is_not_told(tmp_path: Path, files: Files) -> None:
    assert not found_in(files, tmp_path)
