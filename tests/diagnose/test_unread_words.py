"""Words that a launch file gives a program, and what the program does with them."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_file import Launched
from ros2lab.diagnose.launching.unread_words import unread_words
from ros2lab.diagnose.look import Look

NAME = NAMES[0]


def told(folder: Path, words: list[str], *changes: tuple[str, str]) -> list[Finding]:
    files = Files.right(NAME)
    for old, new in changes:
        files.change("PACKAGE/MODULE.py", old, new)
    files.write(folder)
    packages = {package.name: package for package in Look(folder).packages}
    node = Launched(NAME.package, NAME.module, None, (), (), "a.launch.py:3", arguments=tuple(words))
    return [*unread_words(node, packages)]


@pytest.mark.parametrize(
    ("words", "fix"),
    [
        (["period:=0.5", "greeting:=hello"], "write parameters=[{'period': 0.5, 'greeting': 'hello'}] instead of arguments"),
        (["is_loud:=true"], "write parameters=[{'is_loud': True}]"),
        (["/robot/status:=/status"], "write remappings=[('/robot/status', '/status')]"),
        (["__node:=other"], "write name='other'"),
        (["config/robot.yaml"], "write parameters=['config/robot.yaml']"),
        (["-p", "period:=0.5"], "write arguments=['--ros-args', '-p', 'period:=0.5']"),
        (["0.5"], "write parameters=[{'period': 0.5}]"),
    ],
)  # fmt: skip
def test_words_that_nobody_reads_are_told_with_their_right_place(
    tmp_path: Path, words: list[str], fix: str
) -> None:
    (found,) = told(tmp_path, words)
    assert found.code == "words-unread"
    assert fix in found.fix


@pytest.mark.parametrize(
    ("words", "changes"),
    [
        ([], []),
        (["--ros-args", "-p", "period:=0.5"], []),
        (["0.5"], [("import rclpy\n", "import sys\n\nimport rclpy\n"), ("self.count = 0", "self.count = int(sys.argv[1])")]),
        (["--fast"], [("import rclpy\n", "import argparse\n\nimport rclpy\n")]),
        (["--fast"], [("def main(args=None):\n", "def main(args=None):\n    print(args)\n")]),
        (["--fast"], [("import rclpy\n", "from rclpy.utilities import remove_ros_args\nimport rclpy\n")]),
    ],
)  # fmt: skip
def test_words_that_are_read_are_left_alone(
    tmp_path: Path, words: list[str], changes: list[tuple[str, str]]
) -> None:
    assert told(tmp_path, words, *changes) == []


def test_the_words_of_another_program_are_its_own(tmp_path: Path) -> None:
    Files.right(NAME).write(tmp_path)
    packages = {package.name: package for package in Look(tmp_path).packages}
    node = Launched("rviz2", "rviz2", None, (), (), "a.launch.py:3", arguments=("-d", "a.rviz"))
    assert [*unread_words(node, packages)] == []
