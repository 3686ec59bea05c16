"""Values of a launch file that are of the wrong kind: names, substitutions, conditions, texts and times."""

from __future__ import annotations

import ast
import re
import textwrap
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text, of_workspace

FILE = """\
import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, TimerAction
from launch.conditions import IfCondition, LaunchConfigurationEquals, LaunchConfigurationNotEquals, UnlessCondition
from launch.substitutions import (AndSubstitution, EqualsSubstitution, IfElseSubstitution, LaunchConfiguration,
                                  NotSubstitution, OrSubstitution, PythonExpression)
from launch_ros.actions import Node


def rides(context):
    nodes = []
    INSIDE
    return nodes


def generate_launch_description():
    music = LaunchConfiguration('music')
    BEFORE
    return LaunchDescription([
        DeclareLaunchArgument('music', default_value='true'),
        DeclareLaunchArgument('speed', default_value='1.0'),
        DeclareLaunchArgument('prefix', default_value=''),
        OpaqueFunction(function=rides),
        Node(package='my_bot', executable='ears', condition=UnlessCondition(music)),
        HERE
    ])
"""


def files(here: str = "", inside: str = "pass", before: str = "pass") -> Files:
    """Return a workspace with a launch file; `here` is an action, or the arguments of a Node."""
    whole = (
        here
        if here.startswith("TimerAction") or not here
        else f"Node(package='my_bot', executable='talker', {here})"
    )
    text = (
        FILE.replace("HERE", f"{whole}," if whole else "").replace("INSIDE", inside).replace("BEFORE", before)
    )
    ast.parse(text)
    return Files.right(NAMES[1]).put("launch/robot.launch.py", text)


def told(made: Files, folder: Path, *codes: str) -> list[Finding]:
    codes = codes or ("launch-argument", "text-as-condition", "unit-mixed", "launch-unused", "launch-syntax")
    return [finding for finding in of_workspace(made.write(folder)) if finding.code in codes]


READ = "parameters=[{'period': LaunchConfiguration('speed')}]"


@pytest.mark.parametrize(
    ("here", "fix"),
    [
        ("condition=LaunchConfigurationNotEquals(music, '')", "'music' instead of music"),
        ("condition=LaunchConfigurationEquals(LaunchConfiguration('music'), 'x')", "'music' instead of LaunchConfiguration('music')"),
        ("condition=IfCondition(AndSubstitution(LaunchConfigurationEquals('music', 'x'), music))", "EqualsSubstitution(LaunchConfiguration('music'), 'x') instead of"),
        ("condition=IfCondition(OrSubstitution(music, LaunchConfigurationNotEquals('music', 'x')))", "NotEqualsSubstitution(LaunchConfiguration('music'), 'x') instead of"),
        ("condition=IfCondition(UnlessCondition(music))", "NotSubstitution(music) instead of UnlessCondition(music)"),
        ("condition=IfCondition(NotSubstitution(IfCondition(music)))", "music instead of IfCondition(music)"),
        ("condition=music", "IfCondition(music) instead of music"),
        ("condition=EqualsSubstitution(music, 'x')", "IfCondition(EqualsSubstitution(music, 'x')) instead of"),
        ("condition=[IfCondition(music), UnlessCondition(music)]", "IfCondition(AndSubstitution(music, NotSubstitution(music))) instead of"),
        ("name=IfElseSubstitution(IfCondition(music), 'a', 'b')", "music instead of IfCondition(music)"),
        ("condition=IfCondition('music')", "LaunchConfiguration('music') instead of 'music'"),
        ("condition=IfCondition('$(var music)')", "LaunchConfiguration('music') instead of '$(var music)'"),
        ("condition='music'", "IfCondition(LaunchConfiguration('music')) instead of 'music'"),
    ],
)  # fmt: skip
def test_a_value_of_another_kind_is_rewritten(tmp_path: Path, here: str, fix: str) -> None:
    found = told(files(f"{here}, {READ}"), tmp_path, "launch-argument")
    assert [finding.fix.startswith(f"write {fix}") for finding in found] == [True], found


@pytest.mark.parametrize(
    "here",
    [
        "parameters=[{'period': 'speed'}]",
        "namespace='speed'",
        "condition=IfCondition(PythonExpression(['speed', ' > 1']))",
        "remappings=[('/a', 'speed')]",
    ],
)
def test_the_name_of_an_argument_that_nothing_reads_is_not_its_value(tmp_path: Path, here: str) -> None:
    found = told(files(here), tmp_path, "launch-argument")
    assert [finding.fix for finding in found] == ["write LaunchConfiguration('speed') instead of 'speed'"]


@pytest.mark.parametrize(
    "here",
    [
        "condition=IfCondition(music)",
        "condition=IfCondition('true')",
        "name=IfElseSubstitution(EqualsSubstitution(music, 'x'), 'a', 'b')",
        "name=IfElseSubstitution(condition=AndSubstitution(music, music), if_value='a', else_value='b')",
        "condition=LaunchConfigurationEquals('music', 'x')",
        "condition=IfCondition(AndSubstitution(music, NotSubstitution(music)))",
        "condition=IfCondition(PythonExpression([\"'\", music, \"' == 'x'\"]))",
        "name='speed'",
    ],
)
def test_a_value_of_the_right_kind_is_left_alone(tmp_path: Path, here: str) -> None:
    unread = "prefix"  # declared for others
    found = [finding for finding in told(files(f"{here}, {READ}"), tmp_path) if unread not in finding.cause]
    assert found == []


MUSIC = "LaunchConfiguration('music').perform(context)"
NODES = "nodes.append(Node(package='my_bot', executable='wheels'))"


@pytest.mark.parametrize(
    ("inside", "fix"),
    [
        (f"text = {MUSIC}\n    if not text: {NODES}", "text.lower() != 'true' instead of not text"),
        (f"text = {MUSIC}\n    if text == True: {NODES}", "text.lower() == 'true' instead of text == True"),
        (f"text = {MUSIC}\n    if text is False: {NODES}", "text.lower() != 'true' instead of text is False"),
        (f"if bool({MUSIC}): {NODES}", f"{MUSIC}.lower() == 'true' instead of bool({MUSIC})"),
        (f"if context.launch_configurations['music']: {NODES}", "context.launch_configurations['music'].lower() == 'true'"),
        (f"text = {MUSIC}\n    nodes = [] if text else [1]", "text.lower() == 'true' instead of text"),
    ],
)  # fmt: skip
def test_a_text_from_launch_is_no_truth_value(tmp_path: Path, inside: str, fix: str) -> None:
    found = told(files(READ, inside), tmp_path, "text-as-condition")
    assert [finding.fix.startswith(f"write {fix}") for finding in found] == [True], found


@pytest.mark.parametrize(
    "inside",
    [
        f"text = {MUSIC}\n    if text.lower() == 'true': {NODES}",
        f"text = {MUSIC}\n    if text in ('true', '1'): {NODES}",
        f"if LaunchConfiguration('prefix').perform(context): {NODES}",
        f"text = {MUSIC}\n    text = text == 'true'\n    if text: {NODES}",
    ],
)
def test_a_text_that_is_compared_or_may_be_empty_is_right(tmp_path: Path, inside: str) -> None:
    assert told(files(READ, inside), tmp_path, "text-as-condition") == []


EARS = "actions=[Node(package='my_bot', executable='ears')]"


@pytest.mark.parametrize(
    ("here", "fix"),
    [
        (f"TimerAction(period=2000.0, {EARS})", "write period=2.0"),
        (f"TimerAction(period='5000', {EARS})", "write period='5.0'"),
        (f"respawn=True, respawn_delay=3000.0, {READ}", "write respawn_delay=3.0"),
        (f"TimerAction(period=3600.0, {EARS})", ""),
        (f"TimerAction(period=90.0, {EARS})", ""),
    ],
)
def test_launch_counts_in_seconds(tmp_path: Path, here: str, fix: str) -> None:
    found = told(files(here), tmp_path, "unit-mixed")
    assert [finding.fix.removesuffix(" if milliseconds were meant") for finding in found] == [fix][
        : bool(fix)
    ]


@pytest.mark.parametrize(
    ("before", "fix"),
    [
        ("config = os.path.join(get_package_share_directory('my_bot'), 'config', 'robot.yaml')", "remove it, or give config"),
        ("names = [('/a', '/b')]", "add remappings=names"),
        ("values = {'period': 1.0}", "add parameters=[values]"),
        ("share = get_package_share_directory('my_bot')", ""),
        ("_values = {'period': 1.0}", ""),
    ],
)  # fmt: skip
def test_a_value_that_nothing_uses_is_given_to_a_node(tmp_path: Path, before: str, fix: str) -> None:
    found = [
        f for f in told(files(READ, before=before), tmp_path, "launch-unused") if "worked out" in f.cause
    ]
    assert [finding.fix.partition(" to ")[0] for finding in found] == [fix][: bool(fix)]


ACTIONS = {
    "two nodes": ("Node(\n            package='my_bot',\n            executable='talker',\n        )\n        Node(package='my_bot', executable='ears'),", {4: "),"}),
    "three nodes": ("Node(\n            package='my_bot', executable='talker',\n        )\n        Node(\n            package='my_bot', executable='ears',\n        )\n        Node(package='my_bot', executable='wheels'),", {3: "),", 6: "),"}),
    "a comment between": ("Node(\n            package='my_bot', executable='talker',\n        )  # one\n        # two\n        Node(package='my_bot', executable='ears'),", {3: "),  # one"}),
    "on one line": ("Node(package='my_bot', executable='talker')\n        Node(package='my_bot', executable='ears'),", {1: "Node(package='my_bot', executable='talker'),"}),
    "a bracket": ("Node(\n            package='my_bot',\n            executable='talker',\n        Node(package='my_bot', executable='ears'),", {3: "executable='talker'),"}),
}  # fmt: skip


@pytest.mark.parametrize("name", ACTIONS)
def test_what_is_missing_after_several_lines_is_told_where_it_is_missing(tmp_path: Path, name: str) -> None:
    written, lines = ACTIONS[name]
    text = FILE.replace("HERE", written).replace("INSIDE", "pass").replace("BEFORE", "pass")
    begin = text[: text.index(written)].count("\n")
    found = told(Files.right(NAMES[1]).put("launch/robot.launch.py", text), tmp_path)
    (first, _), *others = lines.items()
    assert [finding.code for finding in found] == ["launch-syntax"]
    assert found[0].place.endswith(f":{begin + first}")
    more = [f"on line {begin + number} write `{line}`" for number, line in others]
    assert found[0].fix == "; ".join([f"write `{lines[first]}`", *more])


def test_a_warning_of_what_is_deprecated_is_no_finding(tmp_path: Path) -> None:
    made = files(f"condition=LaunchConfigurationEquals('music', 'true'), {READ}").change(
        "launch/robot.launch.py", "        DeclareLaunchArgument('prefix', default_value=''),\n", ""
    )
    said = (
        "$ ros2 launch my_bot robot.launch.py\n/ws/launch/robot.launch.py:24: UserWarning: The 'LaunchConfigurationEquals' "
        "and 'LaunchConfigurationNotEquals' conditions are deprecated: use IfCondition(EqualsSubstitution(LaunchConfiguration(...), ...)).\n"
        "  condition=LaunchConfigurationEquals('music', 'true'),\n[INFO] [talker-1]: process started with pid [1]\n"
    )
    assert of_text(said, made.write(tmp_path)) == []


@pytest.mark.parametrize(
    "text", ["a: &x {b: 1}\nc: *x\n", "a: &x {b: 1}\nc:\n  <<: *x\n", "a: 1\n---\n- 2\n", "a: !env HOME\n"]
)
def test_yaml_for_something_else_is_left_alone(tmp_path: Path, text: str) -> None:
    assert of_workspace(Files.right(NAMES[1]).put("config/other.yaml", text).write(tmp_path)) == []


def test_an_alias_among_parameters_is_told(tmp_path: Path) -> None:
    made = Files.right(NAMES[1]).put(
        "config/other.yaml", "/**:\n  ros__parameters:\n    a: &x 1.0\n    b: *x\n"
    )
    assert "begins with *" in told(made, tmp_path, "parameter-file-syntax")[0].cause


INCLUDE = """\
import os
from launch import LaunchDescription
from launch.actions import ExecuteProcess, IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource, PythonLaunchDescriptionSource
from launch_ros.actions import Node
from launch_xml.launch_description_sources import XMLLaunchDescriptionSource

HERE = os.path.dirname(__file__)


def generate_launch_description():
    other = os.path.join(HERE, 'other.launch.yaml')
    return LaunchDescription([LINE])
"""


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        (
            "Node(package='my_bot', executable='talker', arguments=['--ros-args', '-p speed:=2.0'])",
            "write '-p', 'speed:=2.0' instead of '-p speed:=2.0'",
        ),
        (
            "Node(package='my_bot', executable='talker', ros_arguments=['--log-level debug'])",
            "write '--log-level', 'debug' instead of '--log-level debug'",
        ),
        (
            "ExecuteProcess(cmd=['ros2 topic list'])",
            "write 'ros2', 'topic', 'list' instead of 'ros2 topic list'",
        ),
        (
            "IncludeLaunchDescription(PythonLaunchDescriptionSource(os.path.join(HERE, 'a.launch.xml')))",
            "write AnyLaunchDescriptionSource instead of PythonLaunchDescriptionSource",
        ),
        (
            "IncludeLaunchDescription(PythonLaunchDescriptionSource(other))",
            "write AnyLaunchDescriptionSource instead of PythonLaunchDescriptionSource",
        ),
        (
            "IncludeLaunchDescription(XMLLaunchDescriptionSource(HERE + '/a.launch.py'))",
            "write AnyLaunchDescriptionSource instead of XMLLaunchDescriptionSource",
        ),
    ],
)
def test_words_in_one_and_files_of_another_kind_are_told(tmp_path: Path, line: str, fix: str) -> None:
    made = Files.right(NAMES[1]).put("launch/robot.launch.py", INCLUDE.replace("LINE", line))
    assert any(finding.fix.startswith(fix) for finding in told(made, tmp_path, "launch-argument"))


@pytest.mark.parametrize(
    "line",
    [
        "Node(package='my_bot', executable='talker', arguments=['--ros-args', '-p', 'speed:=2.0'])",
        "Node(package='my_bot', executable='talker', arguments=['-d', 'some file.rviz'])",
        "Node(package='my_bot', executable='talker', arguments=['-1.5 0 2'])",
        "ExecuteProcess(cmd=['ros2 topic list'], shell=True)",
        "ExecuteProcess(cmd=['ros2', 'topic', 'pub', '/a', 'std_msgs/msg/String', 'data: a b'])",
        "IncludeLaunchDescription(AnyLaunchDescriptionSource(HERE + '/a.launch.xml'))",
        "IncludeLaunchDescription(PythonLaunchDescriptionSource([HERE, '/a.launch.py']))",
        "IncludeLaunchDescription(PythonLaunchDescriptionSource(HERE))",
    ],
)
def test_words_one_by_one_and_files_of_the_kind_are_right(tmp_path: Path, line: str) -> None:
    made = Files.right(NAMES[1]).put("launch/robot.launch.py", INCLUDE.replace("LINE", line))
    found = told(made, tmp_path, "launch-argument")
    assert not [finding for finding in found if "one word" in finding.cause or " reads " in finding.cause]


PATHS = "from launch.substitutions import PathJoinSubstitution, PathSubstitution\nfrom launch_ros.substitutions import FindPackageShare\n"


@pytest.mark.parametrize(
    ("value", "is_early"),
    [
        ("PathSubstitution(FindPackageShare('p')) / 'a' / 'b'", False),
        ("FindPackageShare('p') / 'config' / music", False),
        ("PathJoinSubstitution(['p', 'q']) / 'x'", False),
        ("(PathSubstitution('p') / 'a') / 'b'", False),
        ("music + '/x'", True),
        ("music / 'x'", True),
        ("PathSubstitution('p') + 'x'", True),
        ("'x' / PathSubstitution('p')", True),
        ("os.path.join(PathSubstitution('p'), 'x')", True),
        ("open(PathSubstitution('p') / 'x').read()", True),
        ("str(PathSubstitution('p') / 'x')", True),
        ('f\'{FindPackageShare("p") / "x"}\'', True),
    ],
)
def test_an_operator_of_a_substitution_makes_a_substitution(
    tmp_path: Path, value: str, is_early: bool
) -> None:
    made = files("arguments=[path]", before=f"path = {value}")
    made.change("launch/robot.launch.py", "from launch_ros", f"{PATHS}from launch_ros")
    found = [f for f in told(made, tmp_path, "launch-argument") if "only when launch runs" in f.cause]
    assert len(found) == is_early, found
    for one in found:
        for text in re.findall(r"\(context\):\n(.*?)\n  Then", one.fix, re.DOTALL):
            ast.parse(textwrap.dedent(text.replace("return", "x =")))
            assert "'.perform" not in text


@pytest.mark.parametrize(
    ("here", "before", "fix"),
    [
        ("'''Node(package='my_bot',\n        executable='talker')'''", "pass", 'remove "Node('),
        ("'talker'", "pass", "remove 'talker'"),
        ("TimerAction(period=1.0, actions=['talker'])", "pass", "remove 'talker'"),
        ("name", "name = 'talker'", "remove name"),
        ("*more", "more = [Node(package='my_bot', executable='talker')]", ""),
        ("node", "node = Node(package='my_bot', executable='talker')", ""),
    ],
)
def test_a_text_is_no_action(tmp_path: Path, here: str, before: str, fix: str) -> None:
    text = FILE.replace("HERE", f"{here},").replace("INSIDE", "pass").replace("BEFORE", before)
    root = Files.right(NAMES[1]).put("launch/robot.launch.py", text).write(tmp_path)
    found = [f for f in of_workspace(root) if f.code == "argument-type"]
    assert [finding.fix.startswith(fix) for finding in found] == [True] * bool(fix)


USES = {
    "by its name": ("conf = LaunchConfiguration('speed')", True),
    "by its name alone": ("conf = LaunchConfiguration('prefix')", False),
    "by a name that is worked out": ("confs = [LaunchConfiguration(f'{n}ed') for n in ['spe']]", True),
    "as another name": ("Conf = LaunchConfiguration", True),
    "given to a function": ("confs = [*map(LaunchConfiguration, ['speed'])]", True),
    "as a base class": ("class Choice(LaunchConfiguration):\n        pass", True),
    "in a condition": ("when = LaunchConfigurationEquals('speed', '1.0')", True),
}


@pytest.mark.parametrize("name", USES)
def test_an_argument_is_unused_only_if_all_that_is_used_is_known(tmp_path: Path, name: str) -> None:
    line, is_used = USES[name]
    text = (
        FILE.replace("BEFORE", line)
        .replace("HERE", "")
        .replace("        OpaqueFunction(function=rides),\n", "")
    )
    text = text.replace("INSIDE", "pass").replace("default_value=''", "default_value='x', description='y'")
    look = of_workspace(Files.right(NAMES[1]).put("launch/robot.launch.py", text).write(tmp_path))
    unused = [one.cause for one in look if one.code == "launch-unused"]
    assert any("argument speed is declared" in cause for cause in unused) != is_used
