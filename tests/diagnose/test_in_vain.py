"""What a launch file sets for nobody, and passes to a file that does not take it."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.launching.in_vain import fixed

NAME = NAMES[1]
CODES = ("launch-lost", "launch-unused")
FILE = """\
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import IfCondition
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, ThisLaunchFileDir
from launch_ros.actions import *


def talker(**given):
    return Node(package='my_bot', executable='talker', output='screen', **given)


INCLUDEdef generate_launch_description():
    return LaunchDescription([
        {}
    ])
"""
INCLUDE = """\
def include(name, **given):
    path = PathJoinSubstitution([ThisLaunchFileDir(), name])
    return IncludeLaunchDescription(PythonLaunchDescriptionSource(path), launch_arguments=given.items())


"""
IMPORTS = (
    ("from launch.actions import *", "from launch.actions import ACTIONS"),
    ("from launch_ros.actions import *", "from launch_ros.actions import ROS"),
)
ACTIONS = "DeclareLaunchArgument, GroupAction, IncludeLaunchDescription, LogInfo, OpaqueFunction, SetEnvironmentVariable, SetLaunchConfiguration, TimerAction"
ROS = "Node, PushRosNamespace, SetParameter, SetRemap"
TAKES = "DeclareLaunchArgument('max_speed', default_value='0.2'), talker(parameters=[{'period': LaunchConfiguration('max_speed')}])"


def file(*actions: str) -> str:
    inside = ",\n        ".join(actions)
    text = FILE.replace("{}", inside).replace("INCLUDEdef gen", f"{INCLUDE * ('include(' in inside)}def gen")
    for old, new in IMPORTS:
        text = text.replace(old, new.replace("ACTIONS", ACTIONS).replace("ROS", ROS))
    return text


def told(root: Path, text: str, name: str = "all.launch.py", **others: str) -> list[str]:
    files = Files.right(NAME)
    files.texts[f"src/my_bot/launch/{name}"] = text
    for other, given in others.items():
        files.texts[f"src/my_bot/launch/{other}.launch.py"] = given
    found = of_workspace(files.write(root))
    return [f"{one.cause} {one.fix}" for one in found if f"/{name}" in one.place and one.code in CODES]


@pytest.mark.parametrize(
    ("actions", "late"),
    [
        (("GroupAction([talker(), PushRosNamespace('left')])",), ["PushRosNamespace acts"]),
        (("talker()", "SetRemap('a', 'b')"), ["SetRemap acts"]),
        (("talker()", "SetParameter('period', 1.0)"), ["SetParameter acts"]),
        (("talker()", "SetEnvironmentVariable('ROBOT', 'blue')"), ["SetEnvironmentVariable acts"]),
        (("include('one.launch.py')", "SetParameter('period', 1.0)"), ["SetParameter acts"]),
        (("GroupAction([PushRosNamespace('left'), talker()])",), []),
        (("talker(name='one')", "SetRemap('a', 'b')", "talker(name='two')"), []),
        (("talker(name='one')", "SetParameter('period', 1.0)", "GroupAction([talker(name='two')])"), []),
        (("talker()", "SetLaunchConfiguration('a', 'b')", "LogInfo(msg=LaunchConfiguration('a'))"), []),
        (
            (
                "talker(name='one')",
                "SetRemap('a', 'b')",
                "talker(name='two', condition=IfCondition('false'))",
            ),
            [],
        ),
        (("TimerAction(period=1.0, actions=[talker()])", "SetParameter('period', 1.0)"), []),
        (("SetParameter('period', 1.0)",), []),
    ],
)
def test_what_is_set_after_all_that_starts(tmp_path: Path, actions: tuple[str, ...], late: list[str]) -> None:
    found = told(tmp_path, file(*actions), one=file("talker()"))
    assert [said.startswith(one) for said, one in zip(found, late, strict=True)] == [True] * len(late)


def test_a_file_that_another_includes_may_set_something_for_it(tmp_path: Path) -> None:
    around = file("include('all.launch.py')", "talker(name='two')")
    assert told(tmp_path, file("talker()", "SetParameter('period', 1.0)"), around=around) == []


XML = "<launch>\n  <group>\n    {}\n  </group>\n</launch>\n"
NODE = '<node pkg="my_bot" exec="talker" output="screen"/>'
PUSH = '<push_ros_namespace namespace="left"/>'


@pytest.mark.parametrize(("inside", "count"), [(NODE + PUSH, 1), (PUSH + NODE, 0)])
def test_a_tag_after_the_node(tmp_path: Path, inside: str, count: int) -> None:
    found = told(tmp_path, XML.replace("{}", inside), "all.launch.xml")
    assert [said.startswith("push_ros_namespace acts") for said in found] == [True] * count


@pytest.mark.parametrize(
    ("given", "fix"),
    [
        ("speed='0.9'", "write 'max_speed' instead of 'speed'"),
        ("max_sped='0.9'", "write 'max_speed' instead of 'max_sped'"),
        ("velocity='0.9'", "remove velocity here, or define it in one.launch.py"),
        ("max_speed='0.9'", ""),
        ("max_speed='0.9', use_sim_time='true'", ""),
    ],
)
def test_an_argument_that_the_included_file_does_not_have(tmp_path: Path, given: str, fix: str) -> None:
    found = told(tmp_path, file(f"include('one.launch.py', {given})"), one=file(TAKES))
    assert [fix in said for said in found] == [True] * bool(fix)


OTHER_USES = {
    "a parameter": "talker(parameters=[{'speed': 1.0}])",
    "a node": "talker(name='speed')",
    "a topic": "talker(remappings=[('robot/status', 'speed')])",
    "a word": "LogInfo(msg='speed')",
    "a description": "DeclareLaunchArgument('size', default_value='1', description='the speed'), talker(name=LaunchConfiguration('size'))",
}


@pytest.mark.parametrize("use", OTHER_USES.values(), ids=OTHER_USES)
def test_a_name_that_the_included_file_has_for_something_else(tmp_path: Path, use: str) -> None:
    (said,) = told(tmp_path, file("include('one.launch.py', speed='0.9')"), one=file(TAKES, use))
    assert said.startswith("one.launch.py has no argument speed")


@pytest.mark.parametrize(("read", "count"), [("max_speed", 1), ("speed", 0)])
def test_a_name_in_an_included_file_in_xml(tmp_path: Path, read: str, count: int) -> None:
    inner = NODE.replace("/>", f'><param name="speed" value="$(var {read})"/></node>')
    files = Files.right(NAME)
    text = f'<launch><arg name="max_speed" default="1"/>{inner}</launch>'
    files.texts |= {"src/my_bot/launch/one.launch.xml": text, "src/my_bot/launch/all.launch.xml": INCLUDING}
    found = of_workspace(files.write(tmp_path))
    assert [one.code for one in found if "has no argument speed" in one.cause] == ["launch-unused"] * count


INCLUDING = (
    '<launch><include file="$(dirname)/one.launch.xml"><arg name="speed" value="2"/></include></launch>\n'
)


@pytest.mark.parametrize(
    "one",
    [
        "talker(parameters=[{'period': LaunchConfiguration('speed')}])",
        "talker(name=LaunchConfiguration(variable_name='speed'))",
        "OpaqueFunction(function=lambda context: [LogInfo(msg=context.launch_configurations['speed'])])",
        "include('two.launch.py')",
    ],
)
def test_an_argument_that_the_included_file_reads_or_may_hand_on(tmp_path: Path, one: str) -> None:
    others = {"one": file(TAKES, one), "two": file(TAKES.replace("max_speed", "speed"))}
    assert told(tmp_path, file("include('one.launch.py', speed='0.9')"), **others) == []


def test_an_argument_in_xml(tmp_path: Path) -> None:
    inner = '<arg name="speed" value="0.9"/>'
    text = f'<launch>\n  <include file="$(dirname)/one.launch.py">{inner}</include>\n</launch>\n'
    (said,) = told(tmp_path, text, "all.launch.xml", one=file(TAKES))
    assert "write 'max_speed' instead of 'speed'" in said


HANDLERS = (
    "from launch.event_handlers import OnExecutionComplete, OnProcessExit, OnProcessIO, OnProcessStart\n"
)
NEXT = "[talker(name='next')]"
WAITING = {
    "made again": ("", "talker(), RegisterEventHandler(OnProcessExit(target_action=talker(), on_exit=NEXT))", "another talker"),
    "at its start": ("one = talker()", "one, RegisterEventHandler(OnProcessStart(target_action=talker(), on_start=NEXT))", "another talker"),
    "what it prints": ("one = talker()", "RegisterEventHandler(OnProcessIO(target_action=talker(), on_stdout=lambda event: None)), one", "another talker"),
    "with other values": ("one = talker()", "one, RegisterEventHandler(OnProcessExit(target_action=talker(name='two'), on_exit=NEXT))", "waits for talker, which"),
    "bound anew": ("one = talker()\n    listed = [one]\n    one = talker()", "*listed, RegisterEventHandler(OnExecutionComplete(target_action=one, on_completion=NEXT))", "another talker"),
    "in a dictionary": ("all = {'one': talker(), 'two': talker(name='two')}", "all['one'], RegisterEventHandler(OnProcessExit(target_action=all['two'], on_exit=NEXT))", "waits for talker, which"),
    "the same": ("one = talker()", "RegisterEventHandler(OnProcessExit(target_action=one, on_exit=NEXT)), one", ""),
    "one that a handler starts": ("one, two = talker(), talker(name='two')", "one, RegisterEventHandler(OnProcessExit(target_action=one, on_exit=[two])), RegisterEventHandler(OnProcessExit(target_action=two, on_exit=NEXT))", ""),
    "one that a function may start": ("one, two = talker(), talker(name='two')", "one, RegisterEventHandler(OnProcessExit(target_action=one, on_exit=lambda event, context: [two])), RegisterEventHandler(OnProcessExit(target_action=two, on_exit=NEXT))", ""),
    "one that another function may start": ("one, two = talker(), talker(name='two')\n    def after():\n        return {'two': two}", "one, RegisterEventHandler(OnProcessExit(target_action=one, on_exit=lambda event, context: [*after().values()])), RegisterEventHandler(OnProcessExit(target_action=two, on_exit=NEXT))", ""),
    "one in a group that is left out": ("one = talker()", "GroupAction([one], condition=IfCondition('false')), RegisterEventHandler(OnProcessExit(target_action=one, on_exit=NEXT))", ""),
    "one that comes later": ("one = talker()", "TimerAction(period=1.0, actions=[one]), RegisterEventHandler(OnProcessExit(target_action=one, on_exit=NEXT))", ""),
    "any": ("one = talker()", "one, RegisterEventHandler(OnProcessExit(target_action=lambda action: True, on_exit=NEXT))", ""),
    "every one": ("one = talker()", "one, RegisterEventHandler(OnProcessExit(on_exit=NEXT))", ""),
}  # fmt: skip


@pytest.mark.parametrize(("before", "given", "cause"), WAITING.values(), ids=WAITING)
def test_a_handler_that_waits_for_what_launch_does_not_get(
    tmp_path: Path, before: str, given: str, cause: str
) -> None:
    text = file(given.replace("NEXT", NEXT)).replace(
        "    return LaunchDescription", f"    {before or 'pass'}\n    return LaunchDescription"
    )
    text = text.replace("TimerAction", "RegisterEventHandler, TimerAction", 1).replace(
        "from launch.conditions", f"{HANDLERS}from launch.conditions"
    )
    found = told(tmp_path, text)
    assert [cause in said for said in found] == [True] * bool(cause), found


def speed(default: str) -> str:
    return TAKES.replace("'0.2'", repr(default))


SHARED = {
    "a default": (("include('one.launch.py')", "include('two.launch.py')"), speed("0.2"), "'0.9' for max_speed: one.launch.py"),
    "what is set": (("include('one.launch.py')", "include('two.launch.py')"), "SetLaunchConfiguration('max_speed', '0.1'), talker()", "sets max_speed to '0.1'"),
    "what is passed on": (("include('one.launch.py', max_speed='0.4')", "include('two.launch.py')"), speed("0.9"), "sets max_speed to '0.4'"),
    "an empty default": (("include('two.launch.py', max_speed='0.4')", "include('one.launch.py')"), speed(""), "one.launch.py does not get its default '' for max_speed"),
    "one file twice": (("include('two.launch.py', max_speed='0.4')", "include('two.launch.py')"), "talker()", "sets max_speed to '0.4'"),
    "the one of a group": (("GroupAction([include('one.launch.py'), include('two.launch.py')])",), speed("0.2"), "max_speed='0.9' as an argument"),
    "the same default": (("include('one.launch.py')", "include('two.launch.py')"), speed("0.9"), ""),
    "passed on to both": (("include('one.launch.py', max_speed='0.4')", "include('two.launch.py', max_speed='0.4')"), speed("0.9"), ""),
    "of the file itself": (("DeclareLaunchArgument('max_speed', default_value='0.1')", "include('one.launch.py')", "include('two.launch.py')"), speed("0.2"), ""),
    "each in a group": (("GroupAction([include('one.launch.py')])", "GroupAction([include('two.launch.py')])"), speed("0.2"), ""),
    "as in the group before": (("SetLaunchConfiguration('max_speed', '0.4')", "GroupAction([include('one.launch.py', max_speed='0.4')])", "include('two.launch.py')"), speed("0.2"), ""),
    "set again between them": (("include('one.launch.py')", "SetLaunchConfiguration('max_speed', '0.3')", "include('two.launch.py')"), speed("0.2"), ""),
    "a file only of settings": (("include('one.launch.py')", "include('two.launch.py')"), "SetLaunchConfiguration('max_speed', '0.1')", ""),
    "in the other order": (("include('two.launch.py')", "include('one.launch.py')"), "SetLaunchConfiguration('max_speed', '0.1'), talker()", ""),
}  # fmt: skip


@pytest.mark.parametrize(("actions", "one", "said"), SHARED.values(), ids=SHARED)
def test_what_an_included_file_leaves_for_the_next(
    tmp_path: Path, actions: tuple[str, ...], one: str, said: str
) -> None:
    found = told(tmp_path, file(*actions), one=file(one), two=file(speed("0.9")))
    assert [said in text for text in found] == [True] * bool(said), found


@pytest.mark.parametrize(
    ("first", "second", "count"),
    [("left", "right", 1), ("left", "/right", 0), ("left", "", 0), ("", "right", 0)],
)
def test_a_namespace_that_an_included_file_leaves(
    tmp_path: Path, first: str, second: str, count: int
) -> None:
    one, two = (f"PushRosNamespace('{name}'), talker()" if name else "talker()" for name in (first, second))
    both = file("include('one.launch.py')", "include('two.launch.py')")
    found = told(tmp_path, both, one=file(one), two=file(two))
    assert ["two.launch.py starts its programs in /left/right" in text for text in found] == [True] * count


@pytest.mark.parametrize(
    ("spare", "given", "is_told"),
    [
        ("0.5", "<param name='period' value='0.5'/>", True),
        ("0.5", "<param name='wheel'><param name='period' value='0.5'/></param>", True),
        ("0.5", "<param name='period' value='0.7'/>", False),
        ("0.5", "<param name='period' value='$(var period)'/>", False),
        ("0.5", "<param name='other' value='0.5'/>", False),
        ("0.5", "<param name='period' value='0.5' if='$(eval \"$(var period) > 0\")'/>", False),
        ("", "<param name='period' value='0.5'/>", False),
    ],
)
def test_a_fixed_value_in_place_of_an_argument(tmp_path: Path, spare: str, given: str, is_told: bool) -> None:
    text = f"<launch>\n<arg name='period' default='{spare}'/>\n<node pkg='my_bot' exec='talker'>\n{given}\n</node>\n</launch>\n"
    found = told(tmp_path, text, "all.launch.xml")
    assert [one.partition(":")[0] for one in found] == is_told * [
        "The launch argument period is declared but never used"
    ]


def test_a_fixed_attribute_in_place_of_an_argument_in_yaml(tmp_path: Path) -> None:
    text = "launch:\n- arg: {name: namespace, default: left}\n- node:\n    pkg: my_bot\n    exec: talker\n    namespace: left\n"
    (found,) = told(tmp_path, text, "all.launch.yaml")
    assert found.endswith('write "$(var namespace)" instead of left, and build again')


@pytest.mark.parametrize(
    ("value", "only"),
    [
        ("${var rate}", "${var rate}"),
        ("$var rate", "$var rate"),
        ("${rate}", "${rate}"),
        ("$(var rate)", ""),
        ("${HOME}", ""),
    ],
)
def test_text_that_is_no_substitution(tmp_path: Path, value: str, only: str) -> None:
    path = tmp_path / "a.launch.xml"
    path.write_text(
        f'<launch><arg name="rate" default="2.0"/>\n<node pkg="p" exec="e"><param name="r" value="{value}"/></node></launch>\n',
        encoding="utf-8",
    )
    found = [*fixed(path, path.name)]
    assert [(f.place, f.fix) for f in found] == (
        [("a.launch.xml:2", f'write "$(var rate)" instead of {only}, and build again')] if only else []
    )
