"""Attributes of launch files in XML and YAML that launch does not know: what was meant by each."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

NAME = NAMES[1]


def fixes(folder: Path, name: str, text: str) -> list[str]:
    files = Files.right(NAME)
    files.texts[f"src/{NAME.package}/launch/{name}"] = text
    return [f.fix for f in of_workspace(files.write(folder), None) if f.code == "launch-argument"]


@pytest.mark.parametrize(
    ("written", "fix"),
    [
        ('package="my_bot" executable="talker"', "write exec instead of executable, and write pkg instead of package"),
        ('pkg="my_bot" type="talker"', "write exec instead of type"),
        ('pkg="my_bot" exec="talker" ns="a"', "write namespace instead of ns"),
        ('pkg="my_bot" exec="talker" arguments="a"', "write args instead of arguments"),
        ('pkg="my_bot" exec="talker" nmae="a"', "write name instead of nmae"),
        ('pkg="my_bot" exec="talker" parameters="a"', "remove parameters"),
        ('pkg="my_bot" exec="talker" required="true"', "remove required"),
        ('pkg="my_bot" exec="talker" executable="talker"', "remove executable, and keep the right value as exec, which is there as well"),
        ('pkg="my_bot" exec="talker" name="a" nmae="b"', "remove nmae, and keep the right value as name, which is there as well"),
    ],
)  # fmt: skip
def test_what_was_meant_by_an_attribute_of_xml(tmp_path: Path, written: str, fix: str) -> None:
    assert fixes(tmp_path, "a.launch.xml", f"<launch>\n<node {written}/>\n</launch>\n") == [fix]


@pytest.mark.parametrize(
    ("written", "fix"),
    [
        (
            "package: my_bot, executable: talker",
            "write exec instead of executable, and write pkg instead of package",
        ),
        ("pkg: my_bot, exec: talker, parameters: [{name: a, value: 1}]", "write param instead of parameters"),
        ("pkg: my_bot, exec: talker, remappings: [{from: a, to: b}]", "write remap instead of remappings"),
    ],
)
def test_what_was_meant_by_an_attribute_of_yaml(tmp_path: Path, written: str, fix: str) -> None:
    assert fixes(tmp_path, "a.launch.yaml", f"launch:\n- node: {{{written}}}\n") == [fix]


def test_what_an_element_has_is_right(tmp_path: Path) -> None:
    node = (
        '<node pkg="my_bot" exec="talker" name="a" namespace="b" args="c"><param name="d" value="1"/></node>'
    )
    assert not fixes(tmp_path, "a.launch.xml", f"<launch>\n{node}\n</launch>\n")


NODE = "launch:\n- node:\n    pkg: my_bot\n    exec: talker\n"
SHARE = "$(find-pkg-share my_bot)"


def refusals(folder: Path, text: str) -> list[tuple[str, str]]:
    files = Files.right(NAME)
    files.texts[f"src/{NAME.package}/launch/a.launch.yaml"] = text
    found = [f for f in of_workspace(files.write(folder), None) if f.code == "passed-on"]
    return [(f.place.rpartition(":")[2], f.fix) for f in found]


@pytest.mark.parametrize(
    ("text", "line", "fix"),
    [
        (
            f"{NODE}    param:\n      rpm: 15.0\n      blades: 2\n",
            "5",
            "write `param:`, `- {name: rpm, value: 15.0}` and `- {name: blades, value: 2}` instead of lines 5 to 7",
        ),
        (
            f"{NODE}    param:\n      name: rpm\n      value: 15.0\n    output: screen\n",
            "5",
            "write `param:` and `- {name: rpm, value: 15.0}` instead of lines 5 to 7",
        ),
        (
            f"{NODE}    param: {SHARE}/config/robot.yaml\n",
            "5",
            f"write `param:` and `- {{from: {SHARE}/config/robot.yaml}}` instead of line 5",
        ),
        (
            f"{NODE}    param: {{rpm: 1}}\n{NODE[8:]}    param: {{rpm: 2}}\n",
            "5",
            "write `param:` and `- {name: rpm, value: 1}` instead of line 5, and likewise at the other places",
        ),
        (
            "launch:\n- node: {pkg: my_bot, exec: talker, remap: {from: a, to: b}}\n",
            "2",
            "write `remap: [{from: a, to: b}]` instead of `remap: {from: a, to: b}`",
        ),
        (f"{NODE}    remap: {{a: b}}\n", "5", "write `remap:` and `- {from: a, to: b}` instead of line 5"),
        (
            f"{NODE}    env:\n      A: 'b'\n",
            "5",
            "write `env:` and `- {name: A, value: 'b'}` instead of lines 5 to 6",
        ),
        (f"{NODE}    args:\n    - a\n    - -b\n", "5", "write `args: a -b` instead of lines 5 to 7"),
        (f"{NODE}    name: 7\n", "5", "write `name: '7'` instead of line 5"),
        (
            "launch:\n  node:\n    pkg: my_bot\n    exec: talker\n",
            "2",
            "write `- ` in the place of the two spaces before `node:`",
        ),
        (f"launch: {{{NODE[10:14]}: {{pkg: my_bot, exec: talker}}}}\n", "1", ""),
        (f"{NODE}    param:\n      rpm: 1\n      left:\n        gain: 2\n", "5", ""),
    ],
)
def test_a_value_of_another_shape_is_written_as_launch_takes_it(
    tmp_path: Path, text: str, line: str, fix: str
) -> None:
    assert refusals(tmp_path, text) == [(line, fix)]


def test_values_of_their_shapes_are_no_alarm(tmp_path: Path) -> None:
    more = "    param:\n    - {name: rpm, value: 1}\n    remap: [{from: a, to: b}]\n    args: a b\n"
    assert not refusals(tmp_path, NODE + more)
