"""Two programs whose nodes have one name: both may run, or a launch file starts either."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

NAME = NAMES[1]
LAUNCH = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import EqualsSubstitution, LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        ACTIONS
    ])
"""
BOTH = "Node(package='my_bot', executable='talker', ONE), Node(package='my_bot', executable='ears', TWO)"
GROUPS = (
    "GroupAction([Node(package='my_bot', executable='talker')], ONE), "
    "GroupAction([Node(package='my_bot', executable='ears')], TWO)"
)
DEFAULTS = {"real": "false", "other": "false", "mode": "sim"}
IF = "condition=IfCondition(LaunchConfiguration('{}'))"
UNLESS = IF.replace("If", "Unless")
MODE = "condition=IfCondition(EqualsSubstitution(LaunchConfiguration('mode'), '{}'))"


@pytest.mark.parametrize(
    ("actions", "one", "two", "is_told"),
    [
        ("", "", "", True),
        (BOTH, "", "", True),
        (BOTH, "name='left'", "", False),
        (BOTH, IF.format("real"), UNLESS.format("real"), False),
        (BOTH, IF.format("real"), UNLESS.format("other"), True),
        (BOTH, IF.format("real"), "", True),
        (BOTH, MODE.format("robot"), MODE.format("sim"), False),
        (GROUPS, IF.format("real"), UNLESS.format("real"), False),
    ],
)
def test_nodes_that_are_alternatives_may_have_one_name(
    tmp_path: Path, actions: str, one: str, two: str, *, is_told: bool
) -> None:
    files = Files.right(NAME).change("listener", "__init__('ears')", "__init__('talker')")
    if actions:
        given = actions.replace("ONE", one).replace("TWO", two)
        used = [name for name in DEFAULTS if f"'{name}'" in given]
        given = (
            "".join(f"DeclareLaunchArgument('{n}', default_value='{DEFAULTS[n]}'), " for n in used) + given
        )
        files.put("launch/either.launch.py", LAUNCH.replace("ACTIONS", given))
        files.put("launch/robot.launch.py", LAUNCH.replace("ACTIONS", ""))
    found = [finding for finding in of_workspace(files.write(tmp_path)) if finding.code == "name-twice"]
    assert bool(found) is is_told
