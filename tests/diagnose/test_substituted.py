"""Parameters that launch sets by substitutions, and that YAML reads as another type than the node declares."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

LAUNCH = """import os

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import EnvironmentVariable, LaunchConfiguration, PythonExpression
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description():
    serial = LaunchConfiguration('serial')
    code = 7
    return LaunchDescription([
        DeclareLaunchArgument('serial', default_value='90210042'),
        Node(package='{package}', executable='{module}', parameters=[{{'code': {given}}}]),
    ])
"""
TO_TEXT = (
    "write `'code': ParameterValue({given}, value_type=str)`, with `from launch_ros.parameter_descriptions"
)


@pytest.mark.parametrize(
    ("given", "shown", "wanted", "fix"),
    [
        ("LaunchConfiguration('serial')", ("90210042", "INTEGER"), "STRING", TO_TEXT),
        ("serial", ("3.1", "DOUBLE"), "STRING", TO_TEXT),
        ("EnvironmentVariable('SERIAL')", ("True", "BOOL"), "STRING", TO_TEXT),
        ("PythonExpression(['1 + ', serial])", ("8", "INTEGER"), "STRING", TO_TEXT),
        ("[serial, '0']", ("80", "INTEGER"), "STRING", TO_TEXT),
        ("serial", ("3", "INTEGER"), "DOUBLE", TO_TEXT.replace("=str", "=float")),
        ("7", ("7", "INTEGER"), "STRING", "put it in quotes"),
        ("code", ("7", "INTEGER"), "STRING", "put it in quotes"),
        ("serial", ("fast", "STRING"), "DOUBLE", ""),
        ("ParameterValue(serial, value_type=int)", ("7", "INTEGER"), "STRING", "put it in quotes"),
    ],
)
def test_the_type_is_told_to_launch(
    tmp_path: Path, given: str, shown: tuple[str, str], wanted: str, fix: str
) -> None:
    files = Files.right(NAMES[0]).remove("launch/robot.launch.py")
    names = files.names
    path = files.path("launch/robot.launch.py")
    files.texts[path] = LAUNCH.format(package=names.package, module=names.module, given=given)
    value, kind = shown
    said = (
        f"$ ros2 launch {names.package} robot.launch.py\n"
        f"[talk-1] rclpy.exceptions.InvalidParameterTypeException: Trying to set parameter 'code' to '{value}' "
        f"of type '{kind}', expecting type '{wanted}': code\n"
    )
    found = of_text(said, files.write(tmp_path))[0]
    assert found.code == "parameter-type"
    assert found.place.endswith("robot.launch.py:15")
    assert found.fix.startswith(fix.format(given=given))
    assert ("ParameterValue" in found.fix) is ("ParameterValue" in fix)


def test_the_type_is_told_in_xml(tmp_path: Path) -> None:
    files = Files.right(NAMES[0]).remove("launch/robot.launch.py")
    names = files.names
    text = f"""<launch>
  <arg name="serial" default="90210042"/>
  <node pkg="{names.package}" exec="{names.module}">
    <param name="code" value="$(var serial)"/>
  </node>
</launch>
"""
    files.texts[files.path("launch/robot.launch.xml")] = text
    said = (
        "[talk-1] rclpy.exceptions.InvalidParameterTypeException: Trying to set parameter 'code' to '90210042' "
        "of type 'INTEGER', expecting type 'STRING': code\n"
    )
    found = of_text(said, files.write(tmp_path))[0]
    assert found.place.endswith("robot.launch.xml:4")
    assert found.fix.startswith('write type="str" in this <param>')
