"""Sections of parameter files against the full names under which nodes run: in the code, in launch files, in a terminal."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text
from ros2lab.diagnose.explaining.needed import of_needed
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import read_error

NAME = NAMES[0]
DRIVER = NAME.driver
FILE = f"src/{NAME.package}/config/own.yaml"
LAUNCH = f"""\
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node, PushRosNamespace


def generate_launch_description():
    config = os.path.join(get_package_share_directory('{NAME.package}'), 'config', 'own.yaml')
    return LaunchDescription([ACTIONS])
"""
START = f"Node(package='{NAME.package}', executable='{DRIVER}', parameters=[config], MORE)"


def workspace(root: Path, key: str, space: str = "", actions: str = "") -> Path:
    files = Files.right(NAME)
    files.put("config/own.yaml", f"{key}:\n  ros__parameters:\n    speed: 0.3\n")
    if space:
        files.change("driver", f"__init__('{DRIVER}'", f"__init__('{DRIVER}', namespace='{space}'")
    if actions:
        files.put("launch/own.launch.py", LAUNCH.replace("ACTIONS", actions))
    return files.write(root)


def of_files(root: Path) -> list[Finding]:
    found = Look(root, loads=True).findings
    return [one for one in found if one.code == "parameter-file-node" and one.place.startswith(FILE)]


def run(more: str, logger: str) -> str:
    return (
        f"$ ros2 run {NAME.package} {DRIVER} --ros-args --params-file {FILE} {more}\n"
        f"[INFO] [1700000000.1] [{logger}]: speed 0.5\n^C\n"
    )


@pytest.mark.parametrize(
    ("key", "space", "actions", "runs_as"),
    [
        (DRIVER, "hall", "", f"/hall/{DRIVER}"),
        (f"/{DRIVER}", "/hall/two", "", f"/hall/two/{DRIVER}"),
        (DRIVER, "", START.replace("MORE", "namespace='hall'"), f"/hall/{DRIVER}"),
        (DRIVER, "", f"GroupAction([PushRosNamespace('hall'), {START.replace('MORE', '')}])", f"/hall/{DRIVER}"),
        (DRIVER, "hall", START.replace("MORE", "name='base'"), "/hall/base"),
        (NAME.package, "", START.replace("MORE", "name='base'"), "/base"),
        (DRIVER, "", "DeclareLaunchArgument('as', default_value='base'), " + START.replace("MORE", "name=LaunchConfiguration('as')"), "/base"),
    ],
)  # fmt: skip
def test_a_section_that_no_node_of_the_files_reads(
    tmp_path: Path, key: str, space: str, actions: str, runs_as: str
) -> None:
    (found,) = of_files(workspace(tmp_path, key, space, actions))
    assert found.fix == f"write {runs_as}: instead of {key}:, or /**: for every node"
    assert "silently keeps its defaults" in found.cause


def test_one_program_under_two_names(tmp_path: Path) -> None:
    actions = ", ".join(START.replace("MORE", f"name='{name}'") for name in ("left", "right"))
    (found,) = of_files(workspace(tmp_path, DRIVER, "", actions))
    assert "/left: and /right:" in found.fix


@pytest.mark.parametrize(
    ("key", "space", "actions"),
    [
        (f"/hall/{DRIVER}", "hall", ""),
        (f"hall: {{{DRIVER}: {{ros__parameters: {{speed: 0.3}}}}}}\nother", "hall", ""),
        ("/**", "hall", ""),
        (f"/**/{DRIVER}", "hall", ""),
        (f"/*/{DRIVER}", "hall", ""),
        (DRIVER, "", START.replace("MORE", "")),
        (f"/big/{DRIVER}", "hall", START.replace("MORE", "namespace='big'")),
        ("/hall/base", "hall", START.replace("MORE", "name='base'")),
    ],
)
def test_a_section_that_is_read(tmp_path: Path, key: str, space: str, actions: str) -> None:
    assert not of_files(workspace(tmp_path, key, space, actions))


@pytest.mark.parametrize(
    ("key", "more", "logger", "runs_as"),
    [
        (DRIVER, "-r __ns:=/hall", f"hall.{DRIVER}", f"/hall/{DRIVER}"),
        (DRIVER, "-r __node:=guide", "guide", "/guide"),
        (DRIVER, "--remap __ns:=/a -r __node:=guide", "a.guide", "/a/guide"),
        ("guide", "", DRIVER, f"/{DRIVER}"),
    ],
)
def test_a_terminal_shows_under_which_name_a_node_ran(
    tmp_path: Path, key: str, more: str, logger: str, runs_as: str
) -> None:
    found = of_text(run(more, logger), workspace(tmp_path, key))
    assert found[0].fix == f"write {runs_as}: instead of {key}:, or /**: for every node"


@pytest.mark.parametrize(
    ("key", "more", "logger"),
    [
        (f"/hall/{DRIVER}", "-r __ns:=/hall", f"hall.{DRIVER}"),
        ("guide", "-r __node:=guide", "guide"),
        (DRIVER, "", DRIVER),
        ("/**", "-r __node:=guide", "guide"),
    ],
)
def test_what_the_terminal_shows_to_be_read_is_right(
    tmp_path: Path, key: str, more: str, logger: str
) -> None:
    root, text = workspace(tmp_path, key), run(more, logger)
    assert not of_text(text, root)
    assert not of_needed(of_files(root), read_error(text), Look(root))
