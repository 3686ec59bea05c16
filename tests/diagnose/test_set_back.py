"""Parameters that what comes after them sets back, and launch files that name what is not there."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
from right_workspace import right_workspace
from workspace_files import Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.by_argument import note_arguments

GIVEN = "parameters=[config]"


def told(given: str, folder: Path, before: str = "", parameters: str = "") -> list[Finding]:
    files = right_workspace().change("launch/robot.launch.py", GIVEN, f"parameters={given}")
    if parameters:
        files.put("config/robot.yaml", parameters)
    if before:
        files.change("launch/robot.launch.py", "    config = ", f"    {before}\n    config = ")
    return [
        one for one in of_workspace(files.write(folder)) if one.code in ("launch-argument", "launch-package")
    ]


_LATER = itertools.count()
FAST, OTHER = "LaunchConfiguration('fast')", "{'speed': LaunchConfiguration('other')}"


@pytest.mark.parametrize(
    ("given", "default", "value"),
    [
        (f"[{{'speed': {FAST}}}, config]", "0.9", 0.3),
        (f"[{{'speed': {FAST}}}, config]", "0.3", 0.3),
        (f"[{{'speed': ParameterValue({FAST}, value_type=float)}}, config]", "0.3", 0.3),
        (f"[{{'speed': PythonExpression([{FAST}, ' * 2'])}}, config]", "0.3", 0.3),
        (f"[{{'speed': {FAST}}}, config, {{'other': 1}}]", "0.9", 0.3),
        (f"[{{'speed': {FAST}}}, {{'speed': 0.4}}]", "0.9", 0.4),
        (f"[{{'speed': {FAST}}}, {OTHER}]", "0.9", 0.5),
    ],
)
def test_an_argument_that_stands_before_what_sets_its_parameter_changes_nothing(
    tmp_path: Path, given: str, default: str, value: float
) -> None:
    (found,) = arguments_told(given, tmp_path, default)
    assert f"sets it to {value}: the last value counts, so fast:=... does not change it" in found.cause
    assert Path(found.place).name == "robot.launch.py:18"


@pytest.mark.parametrize(
    "given",
    [
        f"[config, {{'speed': {FAST}}}]",
        f"[{{'speed': {FAST}}}]",
        f"[{{'other': {FAST}}}, config]",
        f"[{{'speed': {FAST}, 'more': {FAST}}}, config]",
        f"[{{'speed': {FAST}}}, config], name=['at_', {FAST}]",
        f"[{{'speed': {FAST}}}, config, {{'speed': {FAST}}}]",
        "[{'speed': 0.9}, config]",
        "[{'speed': __import__('time').time()}, config]",
    ],
)
def test_an_argument_that_stands_last_counts(tmp_path: Path, given: str) -> None:
    assert arguments_told(given, tmp_path, "0.9") == []


@pytest.mark.parametrize(
    ("shown", "noted", "most"),
    [
        (lambda given: {f"p{name}": float(value) for name, value in given.items()}, {f"p{n}": n for n in "abcdefgh"}, 2),
        (lambda given: {"pa": given["a"], "pb": float(given["b"]) * 2}, {"pa": "a", "pb": "b"}, 20),
        (lambda given: {"pa": given["a"], "pb": float(given["a"]) * 2}, {"pa": "a", "pb": "a"}, 20),
        (lambda given: {"pa": given["a"], "p": str(given["b"] == "1.5")}, {"pa": "a", "p": "b"}, 20),
        (lambda given: {"pc": given["c"], "p": given["a"]} if given["a"] == "1.5" else {}, {"pc": "c"}, 20),
        (lambda given: {"pc": given["c"], "at": next(_LATER)}, {"pc": "c"}, 20),
        (lambda _: {"at": next(_LATER)}, {}, 20),
    ],
)  # fmt: skip
def test_the_argument_that_a_parameter_shows_is_told_by_its_value(
    shown: Callable[[Mapping[str, str]], Mapping[str, Any]], noted: Mapping[str, str], most: int
) -> None:
    asked = list[Mapping[str, str]]()

    def load(given: Mapping[str, str]) -> Mapping[str, Any]:
        asked.append(given)
        values = dict.fromkeys("abcdefgh", "1.5")
        node = {"executable": "talk", "given": [shown({**values, **given}), "a.yaml"], "by_argument": []}
        return {"arguments": values, "nodes": [node]}

    told = load({})
    assert note_arguments(told, load) is bool(noted)
    assert {place[1]: place[2] for place in told["nodes"][0]["by_argument"]} == noted
    assert len(asked) <= most + 1


def test_a_file_that_waits_where_an_argument_has_another_value_is_told_of(tmp_path: Path) -> None:
    waits = f"PythonExpression(['0.9 == ', {FAST}, ' or all(True for _ in iter(int, 1))'])"
    given = f"parameters=[{{'a': {waits}}}, config, {{'speed': 0.9, 'word': 'stop'}}]"
    files = with_arguments("0.9").change("launch/robot.launch.py", GIVEN, given)
    found = of_workspace(files.put("config/robot.yaml", _TWO["every"]).write(tmp_path))
    assert "speed is 0.3 and word is 'go' in robot.yaml" in "".join(one.cause for one in found)


@pytest.mark.parametrize(("space", "is_told"), [("", True), ("red", False)])
def test_an_argument_that_a_function_reads_is_told_at_its_own_line(
    tmp_path: Path, space: str, is_told: bool
) -> None:
    """In a namespace, the section of the file is not for the node, so that the argument counts."""
    made = "Node(package='my_bot', executable='velocity_publisher', parameters=[config])"
    function = "OpaqueFunction(function=lambda context: [Node(package='my_bot', executable='velocity_publisher', namespace='SPACE',\n            parameters=[\n            {'speed': float(LaunchConfiguration('fast').perform(context))},\n            config])])"
    files = with_arguments("0.3").change("launch/robot.launch.py", made, function.replace("SPACE", space))
    found = [one for one in of_workspace(files.write(tmp_path)) if one.code == "launch-argument"]
    assert [one.place for one in found] == ["src/my_bot/launch/robot.launch.py:20"] * is_told


def arguments_told(given: str, folder: Path, default: str) -> list[Finding]:
    """Return what is told of a launch file that declares two arguments."""
    files = with_arguments(default).change("launch/robot.launch.py", GIVEN, f"parameters={given}")
    return [one for one in of_workspace(files.write(folder)) if one.code == "launch-argument"]


def with_arguments(default: str) -> Files:
    """Return a workspace whose launch file declares two arguments."""
    names = {
        "launch.actions": "DeclareLaunchArgument, OpaqueFunction",
        "launch.substitutions": "LaunchConfiguration, PythonExpression",
        "launch_ros.parameter_descriptions": "ParameterValue",
    }
    declared = "".join(f"from {module} import {name}\n" for module, name in names.items())
    files = right_workspace().change("launch/robot.launch.py", "def generate", f"{declared}\n\ndef generate")
    made = f"DeclareLaunchArgument('fast', default_value='{default}'), DeclareLaunchArgument('other', default_value='0.5')"
    return files.change("launch/robot.launch.py", "LaunchDescription([", f"LaunchDescription([{made}, ")


_TWO = {
    name: f"{key}:\n  ros__parameters: {{speed: 0.3, word: go}}\n"
    for name, key in (("every", "/**"), ("own", "velocity_publisher"))
}


@pytest.mark.parametrize("section", _TWO)
@pytest.mark.parametrize(
    ("given", "is_lost"),
    [
        ("[config, {'speed': 0.9, 'word': 'stop'}]", True),
        ("[config, {'speed': 0.9}, {'word': 'stop'}]", True),
        ("[config, {'speed': 0.9, 'word': 'go'}]", False),
        ("[config, {'speed': 0.9}]", False),
        ("[{'speed': 0.9, 'word': 'stop'}, config, {'speed': 0.5}]", False),
    ],
)
def test_a_file_of_which_no_value_counts(tmp_path: Path, section: str, given: str, is_lost: bool) -> None:
    found = told(given, tmp_path, parameters=_TWO[section])
    assert [one.cause.partition(",")[0] for one in found] == is_lost * [
        "speed is 0.3 and word is 'go' in robot.yaml"
    ]


def test_a_file_for_two_nodes_may_be_overridden_in_one(tmp_path: Path) -> None:
    given = "[config, {'speed': 0.9, 'word': 'stop'}]),\n        Node(package='my_bot', executable='status_publisher', parameters=[config]"
    assert told(given, tmp_path, parameters=_TWO["every"]) == []


@pytest.mark.parametrize(
    ("before", "fix"),
    [
        ("get_package_share_directory('my_bto')", "write my_bot instead of my_bto"),
        (
            "get_package_share_directory('turtlebot9_bringup')",
            "install it (sudo apt install ros-jazzy-turtlebot9-bringup)",
        ),
        ("import xacro_of_mine", "install the package that provides it"),
    ],
)
def test_what_is_named_and_is_nowhere_is_told(tmp_path: Path, before: str, fix: str) -> None:
    (found,) = told("[config]", tmp_path, before)
    assert found.code == "launch-package"
    assert fix in found.fix


@pytest.mark.parametrize(
    "before", ["import os.path", "import my_bot", "os.environ['ROBOT']", "open('/etc/robot')"]
)
def test_what_may_be_given_later_is_left_alone(tmp_path: Path, before: str) -> None:
    assert told("[config]", tmp_path, before) == []


@pytest.mark.parametrize("before", ["from tools_of_mine import turn", "import tools_of_mine.more"])
def test_a_module_of_the_workspace_may_be_found_once_it_is_installed(tmp_path: Path, before: str) -> None:
    files = right_workspace().put("tools_of_mine/__init__.py", "def turn():\n    pass\n")
    files.put("tools_of_mine/more.py", "")
    files.change("launch/robot.launch.py", "    config = ", f"    {before}\n    config = ")
    assert [one.code for one in of_workspace(files.write(tmp_path)) if one.code == "launch-package"] == []


def test_a_module_is_no_package(tmp_path: Path) -> None:
    (found,) = told("[config]", tmp_path, "get_package_share_directory('robot_node')")
    assert found.code == "launch-package"


@pytest.mark.parametrize(
    ("file", "before", "fix"),
    [
        ("launch/common.py", "from common import TURN", "mv src/my_bot/launch/common.py src/my_bot/my_bot/common.py, write `from my_bot.common import TURN` on line 9, and build again"),
        ("launch/common.py", "import common", "mv src/my_bot/launch/common.py src/my_bot/my_bot/common.py, write `from my_bot import common` on line 9, and build again"),
        ("launch/parts/names.py", "from parts.names import TURN", "mv src/my_bot/launch/parts src/my_bot/my_bot/parts, write `from my_bot.parts.names import TURN` on line 9, and build again"),
        ("common.py", "from common import TURN", "write `py_modules=['common'],` in setup(), and build again"),
        ("tools_of_mine/names.py", "from tools_of_mine.names import TURN", "touch src/my_bot/tools_of_mine/__init__.py, and build again"),
    ],
)  # fmt: skip
def test_a_module_of_the_workspace_that_launch_does_not_find(
    tmp_path: Path, file: str, before: str, fix: str
) -> None:
    files = right_workspace().put(file, "TURN = 1\n")
    files.change("launch/robot.launch.py", "    config = ", f"    {before}\n    config = ")
    (found,) = (one for one in of_workspace(files.write(tmp_path)) if one.code == "launch-package")
    assert found.fix == fix
    assert "neither in this workspace" not in found.cause
