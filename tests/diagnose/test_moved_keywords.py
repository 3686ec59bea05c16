"""Keyword arguments that are given to the wrong call of two, one of which is inside the other."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

LAUNCH = """\
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription, TimerAction
from launch.conditions import IfCondition
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        {}
    ])
"""
INCLUDED = "IncludeLaunchDescription(PythonLaunchDescriptionSource('b.launch.py'), launch_arguments={'x': '0'}.items())"
FIXES = [
    (
        "IncludeLaunchDescription(PythonLaunchDescriptionSource('b.launch.py', launch_arguments={'x': '0'}.items()))",
        f"write `{INCLUDED}`",
    ),
    (
        "IncludeLaunchDescription(PythonLaunchDescriptionSource('b.launch.py', LaunchArguments={'x': '0'}.items()))",
        f"write `{INCLUDED}`",
    ),
    (
        "IncludeLaunchDescription(\n PythonLaunchDescriptionSource('a_folder/and_one_below_it/b.launch.py', launch_arguments={'robot_name': '0'}.items()))",
        "write `launch_arguments={'robot_name': '0'}.items()` in the parentheses of IncludeLaunchDescription() on line 11, and remove it here",
    ),
    (
        "TimerAction(period=LaunchConfiguration('late', actions=[]))",
        "write `TimerAction(period=LaunchConfiguration('late'), actions=[])`",
    ),
    (
        "Node(package='p', executable='n', condition=IfCondition('true', output='screen'))",
        "write `Node(package='p', executable='n', condition=IfCondition('true'), output='screen')`",
    ),
    (
        "Node(package='p', executable='n', condition=IfCondition(LaunchConfiguration('x'), default='0'))",
        "write `IfCondition(LaunchConfiguration('x', default='0'))`",
    ),
    ("TimerAction(period=LaunchConfiguration('late', nonsense=1), actions=[])", ""),
]


@pytest.mark.parametrize(("code", "fix"), FIXES)
def test_an_argument_is_given_to_the_call_that_takes_it(tmp_path: Path, code: str, fix: str) -> None:
    root = Files.right(NAMES[1]).write(tmp_path)
    (path,) = root.glob("src/*/launch/robot.launch.py")
    path.write_text(LAUNCH.format(code))
    (told,) = (finding.fix for finding in of_workspace(root) if finding.code == "argument-unknown")
    assert told == fix if fix else "TimerAction" not in told
