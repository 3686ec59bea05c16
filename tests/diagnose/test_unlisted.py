"""Actions of a launch file that are made and never put into the description: the one at hand is put there."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text, of_workspace
from ros2lab.diagnose.finding import Finding

NAME = NAMES[1]
HEAD = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo, RegisterEventHandler, SetEnvironmentVariable
from launch.event_handlers import OnProcessExit
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
"""
TALK = "Node(package='my_bot', executable='talker', parameters=[{'period': LaunchConfiguration('pace')}])"
PLAIN = "Node(package='my_bot', executable='talker')"
NAMED = "Node(package='my_bot', executable='talker', name='one')"
PACE = "DeclareLaunchArgument('pace', default_value='7.5')"
WRONG = [
    f"pace = {PACE}\nreturn LaunchDescription([\n    {TALK},\n])",
    f"pace = {PACE}\ntalk = {TALK}\nreturn LaunchDescription([talk])",
    f"ld = LaunchDescription()\npace = {PACE}\ntalk = {TALK}\nld.add_action(talk)\nreturn ld",
    f"{PACE}\nreturn LaunchDescription([{TALK}])",
    f"pace = {PACE}\nnodes = [{TALK}]\nreturn LaunchDescription(nodes)",
    f"talk = {PLAIN}\nreturn LaunchDescription([\n])",
    f"pace = {PACE}\ntalk = {TALK}\nreturn LaunchDescription([pace])",
    f"ld = LaunchDescription()\npace = {PACE}\ntalk = {TALK}\nld.add_action(pace)\nreturn ld",
    f"color = SetEnvironmentVariable('RCUTILS_COLORIZED_OUTPUT', '1')\nreturn LaunchDescription([{PLAIN}])",
    f"talk = {PLAIN}\nended = RegisterEventHandler(OnProcessExit(target_action=talk, on_exit=[LogInfo(msg='end')]))\nreturn LaunchDescription([talk])",
    f"ld = LaunchDescription([{PLAIN}])\nnote = LogInfo(msg='up')\nreturn ld",
    f"nodes = [{PLAIN}]\nreturn LaunchDescription()",
    f"# talk\ntalk = {PLAIN}\nnote = LogInfo(msg='up')\nreturn LaunchDescription([note])",
    f"talk = {PLAIN}\nnote = LogInfo(msg='up')\n# start talk as well\nreturn LaunchDescription([note])",
    f"talk = {NAMED}\nother = {NAMED.replace('one', 'two')}\nreturn LaunchDescription([other])",
]
RIGHT = [
    f"pace = {PACE}\ntalk = {TALK}\nreturn LaunchDescription([pace, talk])",
    f"items = []\nitems.append({PACE})\nitems.append({TALK})\nreturn LaunchDescription(items)",
    f"ld = LaunchDescription()\nfor item in ({PACE}, {TALK}):\n    ld.add_action(item)\nreturn ld",
    f"note = LogInfo(msg='up')\nreturn LaunchDescription([\n    {PLAIN},\n    # note,\n])",
    f"talk = {PLAIN}\nnote = LogInfo(msg='up')\nreturn LaunchDescription([\n    # talk,\n    note,\n])",
    f"talk = {PLAIN}\nnote = LogInfo(msg='up')\nreturn LaunchDescription([note])  # [note, talk]",
    f"ld = LaunchDescription()\ntalk = {PLAIN}\n#ld.add_action( talk )  # not today\nreturn ld",
    f"items = []\ntalk = {PLAIN}\n# items.append(talk)\nreturn LaunchDescription(items)",
    f"talk = {PLAIN}\nnote = LogInfo(msg='up')\nreturn LaunchDescription([\n    note,\n    # talk: started in a terminal of its own\n])",
    f"talk = {NAMED}\nother = {NAMED[:-1]}, output='screen')\nreturn LaunchDescription([other])",
    f"talk = {TALK}\nnote = LogInfo(msg='up')\nreturn LaunchDescription([note])",
    f"talk = {PLAIN}\nnote = LogInfo(msg='up')\n# return LaunchDescription([note, talk])\nreturn LaunchDescription([note])",
]


def told(folder: Path, body: str) -> list[Finding]:
    text = body if body.startswith("from") else HEAD + textwrap.indent(body, "    ") + "\n"
    root = Files.right(NAME).put("launch/a.launch.py", text).write(folder)
    codes = ("launch-lost", "launch-argument", "passed-on")
    return [finding for finding in of_workspace(root) if finding.code in codes]


def applied(body: str, fix: str) -> str:
    lines = (HEAD + textwrap.indent(body, "    ")).splitlines()
    (written,) = re.findall(r"write `([^`]+)`", fix)
    if below := re.search(r"` below line (\d+)", fix):
        lines.insert(int(below[1]), f"    {written}")
    elif first := re.search(r"as the first item in the list on line (\d+)", fix):
        lines[int(first[1]) - 1] = lines[int(first[1]) - 1].replace("[", f"[{written} ", 1)
    elif found := re.search(r"below `(\w+)` in the list on line (\d+)", fix):
        number = int(found[2]) - 1
        lines[number] = re.sub(rf"(\[.*\b{found[1]}\b)", rf"\1, {written}", lines[number])
    else:
        lines[-1] = lines[-1].replace("LaunchDescription()", f"LaunchDescription([{written}])")
    if gone := re.search(r"remove line (\d+)", fix):
        lines[int(gone[1]) - 1] = ""
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("body", WRONG)
def test_what_is_at_hand_is_put_into_the_description(tmp_path: Path, body: str) -> None:
    found = told(tmp_path / "wrong", body)
    assert [finding.code for finding in found] == ["launch-lost"]
    mended = applied(body, found[0].fix)
    assert told(tmp_path / "mended", mended) == [], (found[0].fix, mended)


@pytest.mark.parametrize("body", RIGHT)
def test_descriptions_that_hold_all_are_right(tmp_path: Path, body: str) -> None:
    assert told(tmp_path, body) == []


def test_what_launch_prints_of_it_names_the_object_at_hand(tmp_path: Path) -> None:
    (silent,) = told(tmp_path, WRONG[0])
    said = "$ ros2 launch my_bot a.launch.py\n[ERROR] [launch]: Caught exception in launch (see debug for traceback): launch configuration 'pace' does not exist\n"
    (printed,) = of_text(said, tmp_path)
    assert (printed.fix, printed.place) == (silent.fix, silent.place)
    assert printed.fix == "write `pace,` as the first item in the list on line 10"


STRAY = "Node(package='my_bot', executable='strays')"


@pytest.mark.parametrize(
    ("body", "is_started"),
    [
        (f"stray = {STRAY}\nreturn LaunchDescription([{PLAIN},\n    # stray\n])", False),
        (f"ld = LaunchDescription([{PLAIN}])\nstray = {STRAY}\n# ld.add_action(stray)\nreturn ld", False),
        (f"strays = [{STRAY}]\nreturn LaunchDescription([{PLAIN}])", False),
        (f"stray = {STRAY}\nreturn LaunchDescription([stray])", True),
        (f"ld = LaunchDescription()\nstray = {STRAY}\nld.add_action(stray)\nreturn ld", True),
        (f"talk = {PLAIN}\nstray = {STRAY}\nreturn LaunchDescription([talk, RegisterEventHandler(OnProcessExit(target_action=talk, on_exit=[stray]))])", True),
        (f"items = [{PLAIN}]\nstray = {STRAY}\nif items:\n    items.append(stray)\nreturn LaunchDescription(items)", True),
    ],
)  # fmt: skip
def test_what_launch_is_not_given_is_not_started(tmp_path: Path, body: str, is_started: bool) -> None:
    """Also where launch cannot load the file, so that only its text tells."""
    text = f"import cartographer_tools\n{HEAD}{textwrap.indent(body, '    ')}\n"
    root = Files.right(NAME).put("launch/a.launch.py", text).write(tmp_path)
    found = [finding for finding in of_workspace(root) if finding.code == "launch-executable"]
    assert len(found) == is_started, found
