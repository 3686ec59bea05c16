"""A value of launch that Python needs at once: it is asked for in a function that launch calls."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

import pytest

from launch import LaunchContext
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from ros2lab.diagnose.launching.launch_values import used_too_early
from ros2lab.diagnose.sources.python_source import PythonSource

HEAD = """\
import functools
import json
import os
import subprocess
from pathlib import Path

import yaml
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution


def generate_launch_description():
    where = 'WHERE'
    argument = DeclareLaunchArgument('dir', default_value=where)
    directory = LaunchConfiguration('dir')
"""
LIST = "return LaunchDescription([\n    argument,\n    LogInfo(\n        msg=values['k']),\n])"
WRONG = [
    f"with open(os.path.join(directory, 'v.yaml')) as f:\n    values = yaml.safe_load(f)\n{LIST}",
    f"values = yaml.safe_load((Path(directory) / 'v.yaml').read_text())\n{LIST}",
    f"with open(f'{{directory}}/v.json') as f:\n    values = json.load(f)\n{LIST}",
    f"with open(directory + '/v.yaml') as f:\n    values = yaml.safe_load(f)\n{LIST}",
    f"path = os.path.join(LaunchConfiguration('dir'), 'v.yaml')\nvalues = yaml.safe_load(Path(path).read_text())\n{LIST}",
    f"text = subprocess.check_output(['cat', PathJoinSubstitution([directory, 'v.yaml'])]).decode()\nvalues = yaml.safe_load(text)\n{LIST}",
    f"values = {{}}\nif os.path.exists(directory):\n    values['k'] = 'v'\n{LIST}",
    "ld = LaunchDescription()\nld.add_action(argument)\npath = os.path.join(directory, 'v.json')\nvalues = json.loads(Path(path).read_text())\nlog = LogInfo(msg=values['k'])\nld.add_action(log)\nreturn ld",
]
RIGHT = [
    "values = functools.partial(print, directory)\nreturn LaunchDescription([argument])",
    "def setup(context):\n    directory = LaunchConfiguration('dir').perform(context)\n    values = yaml.safe_load(open(directory))\n    return []\nreturn LaunchDescription([argument])",
    "values = json.load(open(where + '/v.json'))\nreturn LaunchDescription([argument])",
    "return LaunchDescription([argument, LogInfo(msg=directory)])",
    # A name that the function at hand binds is another one.
    "def near(directory):\n    return directory == 'F'\nreturn LaunchDescription([argument, LogInfo(msg=str(near('F')))])",
    "near = lambda directory: directory == 'F'\nreturn LaunchDescription([argument])",
    "def near(path):\n    with open(path) as directory:\n        return yaml.safe_load(directory)\nreturn LaunchDescription([argument])",
    "def near(text):\n    for directory in text:\n        if directory == 'F':\n            return text\nreturn LaunchDescription([argument])",
    "def near(path):\n    try:\n        return path.read()\n    except OSError as directory:\n        return str(directory)\nreturn LaunchDescription([argument])",
    "def near(text):\n    directory, rest = text\n    return directory == 'F'\nreturn LaunchDescription([argument])",
]


def file_of(lines: str, folder: Path) -> PythonSource:
    (folder / "v.json").write_text('{"k": "v"}')
    (folder / "v.yaml").write_text("k: v\n")
    text = HEAD.replace("WHERE", str(folder)) + textwrap.indent(lines, "    ")
    return PythonSource("robot", "robot.launch.py", f"{text}\n")


def applied(text: str, fix: str) -> str:
    """Return a file after what a fix says: lines go, a function comes above the return, and one call is written."""
    lines = text.splitlines()
    said, function, then = re.fullmatch(r"(.*?):\n(.*)\n  Then (.*)", fix, re.DOTALL).groups()  # type: ignore[union-attr]
    for first, last in re.findall(r"lines? (\d+)(?: to (\d+))?", said.rpartition("instead of")[2]):
        for number in range(int(first), int(last or first) + 1):
            lines[number - 1] = ""
    call = then.split("`")[1]
    end = next(n for n, line in enumerate(lines) if line.startswith("    return "))
    if ".add_action(" in call:
        lines.insert(end, f"    {call}")
    else:
        lines[end] = lines[end].replace("([", f"([{call}, ", 1)
    lines.insert(end, function)
    return "\n".join(["from launch.actions import OpaqueFunction", *lines])


@pytest.mark.parametrize("lines", WRONG)
def test_what_is_written_so_does_what_was_meant(tmp_path: Path, lines: str) -> None:
    source = file_of(lines, tmp_path)
    first = next(used_too_early(source))
    names: dict[str, object] = {}
    exec(applied(source.text, first.fix), names)
    actions = names["generate_launch_description"]().entities  # type: ignore[operator]
    context = LaunchContext()
    for kind in (DeclareLaunchArgument, OpaqueFunction):
        (action,) = (one for one in actions if isinstance(one, kind))
        made = action.execute(context)
    (log,) = made or ()
    assert "".join(one.perform(context) for one in log.msg) == "v"


@pytest.mark.parametrize("lines", RIGHT)
def test_what_only_hands_a_value_on_is_right(tmp_path: Path, lines: str) -> None:
    assert [*used_too_early(file_of(lines, tmp_path))] == []


@pytest.mark.parametrize(
    "beside", ["def near(directory):\n    return directory", "def near():\n    directory = 1"]
)
def test_what_another_function_binds_hides_nothing(tmp_path: Path, beside: str) -> None:
    lines = f"{beside}\nvalues = directory == 'F'\nreturn LaunchDescription([argument])"
    assert [found.place for found in used_too_early(file_of(lines, tmp_path))] == ["robot.launch.py:19"]


def test_a_path_that_launch_itself_uses_is_joined_by_launch(tmp_path: Path) -> None:
    lines = (
        "path = os.path.join(directory, 'v.yaml')\nreturn LaunchDescription([argument, LogInfo(msg=path)])"
    )
    (found,) = used_too_early(file_of(lines, tmp_path))
    assert "PathJoinSubstitution([directory, 'v.yaml'])" in found.fix
