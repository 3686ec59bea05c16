"""Arguments that are typed after a launch file's name, against those that the file takes, however it is written."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

NAME = NAMES[1]
PYTHON = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, ThisLaunchFileDir
from launch_ros.actions import Node


def generate_launch_description():
    speed = LaunchConfiguration('speed')
    node = Node(package='my_bot', executable='talker', parameters=[{{'period': speed}}])
    return LaunchDescription([{}, node])
"""
FORMS = {
    "speed.launch.py": PYTHON.format("DeclareLaunchArgument('speed', default_value='1.0')"),
    "named.launch.py": PYTHON.format(
        "*[DeclareLaunchArgument(name, default_value='1') for name in ('speed', 'turn')]"
    ),
    "group.launch.py": PYTHON.format(
        "GroupAction([DeclareLaunchArgument('speed', default_value='1.0')], scoped=False)"
    ),
    "around.launch.py": PYTHON.format(
        "IncludeLaunchDescription(AnyLaunchDescriptionSource([ThisLaunchFileDir(), '/speed.launch.py']))"
    ),
    "needed.launch.py": PYTHON.format("DeclareLaunchArgument('speed')"),
    "speed.launch.xml": '<launch><arg name="speed" default="1.0"/><node pkg="my_bot" exec="talker"/></launch>\n',
    "around.launch.xml": '<launch><include file="$(dirname)/speed.launch.py"/></launch>\n',
    "speed.launch.yaml": "launch:\n- arg: {name: speed, default: '1.0'}\n- node: {pkg: my_bot, exec: talker}\n",
}


def told(folder: Path, form: str, argument: str) -> str:
    files = Files.right(NAME)
    for name in ("speed.launch.py", form):
        files.texts[f"src/{NAME.package}/launch/{name}"] = FORMS[name]
    root = files.write(folder)
    text = f"$ ros2 launch my_bot {form} {argument}\n[INFO] [talker-1]: process started with pid [7]\n"
    return " ".join(f"{one.cause} {one.fix}" for one in of_text(text, root))


@pytest.mark.parametrize("form", FORMS)
def test_an_argument_that_the_file_takes_is_right(tmp_path: Path, form: str) -> None:
    assert "has no argument" not in told(tmp_path, form, "speed:=0.5")


@pytest.mark.parametrize("form", FORMS)
def test_one_that_it_does_not_take_is_told(tmp_path: Path, form: str) -> None:
    said = told(tmp_path, form, "sped:=0.5")
    assert f"{form} has no argument sped" in said
    assert f"ros2 launch my_bot {form} speed:=0.5" in said
