"""Launch configurations that nobody declares: with which default they are to be declared."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

NAME = NAMES[1]
LAUNCH = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([MORE
        Node(package='my_bot', executable='talker', USE),
    ])
"""
FAILED = "$ ros2 launch my_bot a.launch.py\n[ERROR] [launch]: Caught exception in launch (see debug for traceback): launch configuration '{}' does not exist\n"


def fix(root: Path, name: str, use: str, more: str = "") -> str:
    text = LAUNCH.replace("USE", use).replace("MORE", more)
    files = Files.right(NAME).put("launch/a.launch.py", text)
    return of_text(FAILED.format(name), files.write(root))[0].fix


@pytest.mark.parametrize(
    ("name", "use", "value"),
    [
        ("period", "parameters=[{'period': LaunchConfiguration('period')}]", "2.0"),
        ("pace", "parameters=[{'period': LaunchConfiguration('pace')}]", "2.0"),
        ("use_sim_time", "parameters=[{'use_sim_time': LaunchConfiguration('use_sim_time')}]", "false"),
        ("ns", "namespace=LaunchConfiguration('ns')", ""),
        ("go", "condition=IfCondition(LaunchConfiguration('go'))", "true"),
    ],
)
def test_the_default_is_that_of_what_it_sets(tmp_path: Path, name: str, use: str, value: str) -> None:
    assert fix(tmp_path, name, use).startswith(
        f"write `DeclareLaunchArgument({name!r}, default_value={value!r}),`"
    )


def test_a_similar_declared_name_is_meant(tmp_path: Path) -> None:
    more = "\n        DeclareLaunchArgument('period', default_value='1.0'),"
    assert "'period'" in fix(tmp_path, "perod", "parameters=[{'period': LaunchConfiguration('perod')}]", more)
