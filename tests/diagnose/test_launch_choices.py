"""A choice of a launch file that is made too early: what is told for it chooses rightly when launch runs."""

from __future__ import annotations

import os
from typing import Any

import pytest

from launch import LaunchContext
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from ros2lab.diagnose.launching.launch_values import used_too_early
from ros2lab.diagnose.sources.python_source import PythonSource

HEAD = """\
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PythonExpression
from launch_ros.actions import Node

weather = LaunchConfiguration('weather')
"""
IF = "if {}:\n    gap = 8.0\nelse:\n    gap = 3.0\n"
# What is written, and what comes out for values of the argument.
CHOICES: dict[str, tuple[str, dict[str, Any]]] = {
    "equal": (IF.format("weather == 'storm'"), {"storm": 8.0, "sun": 3.0}),
    "not equal": (IF.format("weather != 'storm'"), {"storm": 3.0, "sun": 8.0}),
    "one of several": (IF.format("weather in ('storm', 'hail')"), {"hail": 8.0, "sun": 3.0}),
    "by itself": (IF.format("weather"), {"true": 8.0, "False": 3.0}),
    "not": (IF.format("not weather"), {"true": 3.0, "false": 8.0}),
    "a number": (IF.format("weather > 5"), {"7": 8.0, "2": 3.0}),
    "a default above": ("gap = 3.0\nif weather == 'storm':\n    gap = 8.0\n", {"storm": 8.0, "sun": 3.0}),
    "in one line": ("gap = 8.0 if weather == 'storm' else 3.0\n", {"storm": 8.0, "sun": 3.0}),
    "a value of another function": ("def other():\n    gap = 1.0\n\n\ngap = 3.0\nif weather == 'storm':\n    gap = 8.0\n", {"storm": 8.0, "sun": 3.0}),
    "texts": ("gap = 'far' if weather == 'storm' else 'near'\n", {"storm": "far", "sun": "near"}),
    "three": ("if weather == 'storm':\n    gap = 8\nelif weather == 'fog':\n    gap = 6\nelse:\n    gap = 3\n", {"storm": 8, "fog": 6, "sun": 3}),
}  # fmt: skip


def told(text: str) -> str:
    return next(used_too_early(PythonSource("launch_file", "a.launch.py", f"{HEAD}{text}"))).fix


@pytest.mark.parametrize("name", CHOICES)
def test_what_is_told_chooses_when_launch_runs(name: str) -> None:
    text, outcomes = CHOICES[name]
    fix = told(text)
    written = fix.removeprefix("write ").partition(" instead of ")[0].strip("`").removeprefix("gap = ")
    scope: dict[str, Any] = {}
    exec(f"{HEAD}\ngap = {written}", scope)
    for given, expected in outcomes.items():
        context = LaunchContext()
        context.launch_configurations["weather"] = given
        assert scope["gap"].perform(context) == str(expected)


@pytest.mark.parametrize(
    "text",
    [
        "if weather == 'storm':\n    actions.append(Node(package='a', executable='b'))\n",
        "if weather == 'storm':\n    tower = Node(package='a', executable='b')\nelse:\n    tower = Node(package='a', executable='c')\n",
        "if weather == 'storm':\n    gap = 8.0\n    actions.append(Node(package='a', executable='b'))\n",
    ],
)
def test_a_choice_of_actions_is_a_condition_of_theirs(text: str) -> None:
    assert "condition=IfCondition(" in told(text)


TEXTS = {
    "a sum": "weather + '.yaml'",
    "a longer sum": "'in_' + weather + '_' + weather + '.yaml'",
    "a text with a value in it": "f'in_{weather}.yaml'",
    "a template": "'in_%s.yaml' % weather",
    "a template with two": "'%s_%s.yaml' % (weather, weather)",
    "a path": "os.path.join('/share', 'config', weather + '.yaml')",
    "a path of a list": "os.path.join('/share', [weather, '.yaml'])",
    "a path of a text with a value": "os.path.join('/share', f'{weather}.yaml')",
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_a_text_is_written_as_launch_joins_it(text: str) -> None:
    fix = told(f"import os\n\nname = {text}\n")
    assert f" instead of {text}" in fix
    names: dict[str, Any] = {}
    exec(f"{HEAD}import os\nfrom launch.substitutions import PathJoinSubstitution", names)
    made = eval(fix.removeprefix("write ").partition(" instead of ")[0], names)
    context = LaunchContext()
    context.launch_configurations["weather"] = "sun"
    right = eval(text.replace("[weather, '.yaml']", "weather + '.yaml'"), {"os": os, "weather": "sun"})
    assert perform_substitutions(context, normalize_to_list_of_substitutions(made)) == right


@pytest.mark.parametrize("text", ["['-f', weather + '.yaml']", "['-f'] + [weather + '.yaml']"])
def test_a_text_in_a_list_is_written_alone(text: str) -> None:
    assert told(f"words = {text}\n") == "write [weather, '.yaml'] instead of weather + '.yaml'"
