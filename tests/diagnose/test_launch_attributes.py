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
