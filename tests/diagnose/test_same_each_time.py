"""The same workspace has the same findings each time, whatever the order of sets and folders."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

ASK = """\
import os, random, sys
from pathlib import Path

chance, real, really = random.Random(int(sys.argv[1])), os.scandir, os.listdir


class Mixed:
    def __init__(self, rows):
        self.rows = iter(mixed([*rows]))

    def __iter__(self):
        return self

    def __next__(self):
        return next(self.rows)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def close(self):
        pass


def mixed(rows):
    return chance.sample(rows, len(rows))


os.scandir, os.listdir = lambda path=".": Mixed(real(path)), lambda path=".": mixed(really(path))
from ros2lab.diagnose import diagnose

for finding in diagnose(Path(sys.argv[2])):
    print(finding)
"""
UNUSED = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        *(DECLARED),
        Node(package='my_bot', executable='talker'),
    ])
"""
WORDS = ("speed", "turn", "width", "length", "colour", "height")


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a workspace with many faults of one kind, which differ in nothing but their names."""
    files = Files.right(NAMES[1])
    declared = ", ".join(f"DeclareLaunchArgument('{word}', default_value='1')" for word in WORDS)
    files.put("launch/unused.launch.py", UNUSED.replace("DECLARED", declared))
    for word in WORDS:
        files.put(f"config/{word}.yaml", "wheels:\n    period: 1.0\n").put(
            f"my_bot/{word}.py", "import nosuch\n"
        )
    return files.write(tmp_path_factory.mktemp("same"))


def asked(workspace: Path, seed: str) -> str:
    return subprocess.run(
        [sys.executable, "-c", ASK, seed, workspace],
        env={**os.environ, "PYTHONHASHSEED": seed},
        stdout=subprocess.PIPE,
        text=True,
        timeout=300,
        check=True,
    ).stdout


def test_the_order_of_sets_and_folders_reaches_no_answer(workspace: Path) -> None:
    first = asked(workspace, "1")
    assert first.count("is declared but never used") == len(WORDS)
    assert asked(workspace, "2") == first
