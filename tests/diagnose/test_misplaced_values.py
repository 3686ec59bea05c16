"""Values under a keyword of a node in a launch file that does not take them, and those that are right."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.launching.misplaced_values import joined_words, misplaced_values
from ros2lab.diagnose.sources.python_source import PythonSource


def told(keywords: str) -> list[str]:
    text = f"from launch_ros.actions import Node\n\nNode(package='a', executable='b', {keywords})\n"
    found = [*misplaced_values(PythonSource("launch_file", "a.launch.py", text))]
    assert {one.code for one in found} <= {"launch-argument"}
    return [one.fix for one in found]


@pytest.mark.parametrize(
    ("keywords", "fix"),
    [
        ("params=[{'size': 4.5}]", "write parameters=[{'size': 4.5}] instead of params=[{'size': 4.5}]"),
        ("params={'size': 4.5}", "write parameters=[{'size': 4.5}]"),
        ("remaps=[('/a', '/b')]", "write remappings=[('/a', '/b')]"),
        ("arguments=[{'size': 4.5}]", "write parameters=[{'size': 4.5}]"),
        ("parameters=['size:=4.5', 'kind:=big']", "write parameters=[{'size': 4.5, 'kind': 'big'}]"),
        ("parameters=[('size', 4.5)]", "write parameters=[{'size': 4.5}]"),
        ("parameters=[('/a', '/b')]", "write remappings=[('/a', '/b')]"),
        ("ros_arguments=['size:=4.5']", "write ros_arguments=['-p', 'size:=4.5']"),
    ],
)
def test_the_form_of_a_value_says_where_it_belongs(keywords: str, fix: str) -> None:
    (found,) = told(keywords)
    assert found.startswith(fix)


@pytest.mark.parametrize(
    "keywords",
    [
        "parameters=[{'size': 4.5}]",
        "parameters=[{'size': 4.5}, 'config/a.yaml']",
        "parameters=['config/a.yaml']",
        "parameters=[path]",
        "parameters=[(folder, '/a.yaml'), {'size': 1}]",
        "parameters=[]",
        "remappings=[('/a', '/b'), ('c', 'd')]",
        "arguments=['--ros-args', '-p', 'size:=4.5']",
        "arguments=['size:=4.5']",
        "ros_arguments=['-p', 'size:=4.5']",
        "ros_arguments=['--log-level', 'debug']",
        "additional_env={'A': 'b'}",
        "env={'A': 'b'}",
        "name='c', output='screen'",
        "**more",
    ],
)
def test_values_where_they_belong_are_left_alone(keywords: str) -> None:
    assert told(keywords) == []


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("['--ros-args', '-r a:=b']", "'-r', 'a:=b'"),
        ("['x', '-d a.rviz']", "'-d', 'a.rviz'"),
        ("['--param-file', path, '-r a:=b']", "'-r', 'a:=b'"),
        ("['--controller-ros-args', '-r a:=b -p c:=1']", ""),
        ("['x', '--param-file', path, '--controller-ros-args', '-r a:=b']", ""),
        ("['-c', '-x -y']", ""),
    ],
)
def test_words_in_one_item_are_taken_apart_unless_they_may_be_an_options_value(words: str, said: str) -> None:
    text = f"from launch_ros.actions import Node\n\nNode(package='a', executable='b', arguments={words})\n"
    found = [*joined_words(PythonSource("launch_file", "a.launch.py", text))]
    assert len(found) == bool(said)
    assert all(one.fix.startswith(f"write {said} instead of") for one in found)


@pytest.mark.parametrize(
    ("given", "codes"),
    [
        ("node_executable='driver'", ["launch-argument"]),
        ("\n    node_executable='driver',\n    node_name='d'", ["launch-argument"]),
        ("executable='driver', node_name='d'", ["launch-argument"]),
        ("", ["argument-missing"]),
    ],
)
def test_an_older_keyword_is_told_once(tmp_path: Path, given: str, codes: list[str]) -> None:
    text = f"from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\ndef generate_launch_description():\n    return LaunchDescription([Node(package='my_bot', {given})])\n"
    files = Files.right(NAMES[1]).put("launch/robot.launch.py", text)
    found = [one.code for one in of_workspace(files.write(tmp_path))]
    assert [code for code in found if code in ("launch-argument", "argument-missing")] == codes
