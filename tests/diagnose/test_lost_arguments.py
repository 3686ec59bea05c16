"""Launch configurations that do not exist: given by the file that includes another, declared and lost, or neither."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

INNER = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    declared = DeclareLaunchArgument('team', default_value='red')
    team = LaunchConfiguration('team')
    return LaunchDescription([
        declared,
        Node(package='my_bot', executable='talker', namespace=team),
    ])
"""
OUTER = """\
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch.substitutions import ThisLaunchFileDir


def generate_launch_description():
    source = AnyLaunchDescriptionSource([ThisLaunchFileDir(), '/inner.launch.py'])
    return LaunchDescription([
        IncludeLaunchDescription(source, launch_arguments={'team': 'red'}.items()),
    ])
"""
OUTER_XML = """\
<launch>
  <include file="$(dirname)/inner.launch.py"><arg name="team" value="red"/></include>
</launch>
"""
DECLARED = "    declared = DeclareLaunchArgument('team', default_value='red')\n"


def told(inner: str, outer: tuple[str, str], root: Path) -> list[tuple[str, str, str]]:
    files = Files.right(NAMES[1]).put("launch/inner.launch.py", inner)
    files.change("setup.py", "launch/*.launch.py", "launch/*")
    if outer[1]:
        files.put(*outer)
    return [(finding.code, finding.place, finding.fix) for finding in of_workspace(files.write(root))]


@pytest.mark.parametrize("outer", [("launch/all.launch.py", OUTER), ("launch/all.launch.xml", OUTER_XML)])
def test_one_that_the_including_file_gives_is_no_alarm(tmp_path: Path, outer: tuple[str, str]) -> None:
    inner = INNER.replace(DECLARED, "").replace("        declared,\n", "")
    assert told(inner, outer, tmp_path) == []


def test_one_that_nothing_gives_is_told_with_its_line(tmp_path: Path) -> None:
    inner = INNER.replace(DECLARED, "").replace("        declared,\n", "")
    ((code, place, _),) = told(inner, ("", ""), tmp_path)
    assert (code, place) == ("passed-on", "src/my_bot/launch/inner.launch.py:8")


def test_one_whose_declaration_is_not_in_the_description(tmp_path: Path) -> None:
    ((code, place, fix),) = told(INNER.replace("        declared,\n", ""), ("", ""), tmp_path)
    assert (code, place) == ("launch-lost", "src/my_bot/launch/inner.launch.py:8")
    assert fix == "write `declared,` as the first item in the list on line 10"
    assert told(INNER, ("", ""), tmp_path) == []
