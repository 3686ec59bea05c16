"""Files that launch files start by their paths, and parameter files that several starts share."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_workspace

LAUNCH = """\
import os

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch import LaunchDescription
from launch.actions import GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import PathJoinSubstitution
from launch_ros.actions import Node, PushRosNamespace
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    share = get_package_share_directory('my_bot')
    BEFORE
    return LaunchDescription([
        ACTIONS
    ])
"""
ROW = "    data_files=[\n        ('share/my_bot/scripts', ['scripts/run.sh', 'scripts/plain.sh']),\n"
SHARED = (
    "Node(package='my_bot', executable='{}', NAMEparameters=[os.path.join(share, 'config', 'more.yaml')])"
)


def launching(actions: str, before: str = "") -> str:
    return LAUNCH.replace("ACTIONS", actions).replace("BEFORE", before)


def told(root: Path, files: Files, code: str) -> list[Finding]:
    files.change("setup.py", "    data_files=[\n", ROW)
    files.put("scripts/run.sh", "#!/bin/sh\n").put("scripts/plain.sh", "#!/bin/sh\n")
    files.write(root)
    (root / "src/my_bot/scripts/run.sh").chmod(0o755)
    return [finding for finding in of_workspace(root) if finding.code == code]


def beside(name: str) -> str:
    return f"os.path.join(share, 'scripts', '{name}')"


@pytest.mark.parametrize(
    ("executable", "cause"),
    [
        (beside("run.sh"), ""),
        ("PathJoinSubstitution([FindPackageShare('my_bot'), 'scripts', 'run.sh'])", ""),
        ("os.path.join(get_package_prefix('my_bot'), 'lib', 'my_bot', 'talker')", ""),
        ("'/bin/true'", ""),
        ("os.path.join(os.path.dirname(__file__), 'run.sh')", ""),
        (beside("plain.sh"), "src/my_bot/scripts/plain.sh is not marked as executable"),
        (beside("absent.sh"), "setup.py installs no such file"),
        ("'talkers'", "my_bot has no such executable"),
    ],
)
def test_a_file_is_started_as_it_is_installed(tmp_path: Path, executable: str, cause: str) -> None:
    files = Files.right(NAMES[1])
    files.put("launch/more.launch.py", launching(f"Node(package='my_bot', executable={executable}),"))
    found = told(tmp_path, files, "launch-executable")
    assert [cause in finding.cause and "share:" not in finding.cause for finding in found] == [True] * bool(
        cause
    )


@pytest.mark.parametrize(
    ("executable", "fix"),
    [
        ("talkers", "write talker instead of talkers"),
        (
            "wheel_speed",
            "remove this Node, or write the program wheel_speed, with its entry point in setup.py",
        ),
        ("controller", "remove this Node, or write the program controller, with its entry point in setup.py"),
        ("talk", "write talker instead of talk"),
    ],
)
def test_a_program_that_is_gone_is_like_none(tmp_path: Path, executable: str, fix: str) -> None:
    files = Files.right(NAMES[1])
    files.put("launch/more.launch.py", launching(f"Node(package='my_bot', executable={executable!r}),"))
    assert [finding.fix for finding in told(tmp_path, files, "launch-executable")] == [fix]


def test_of_entry_points_that_are_not_known_nothing_is_told(tmp_path: Path) -> None:
    files = Files.right(NAMES[1]).change("setup.py", "entry_points={", "entry_points=found() or {")
    files.put("launch/more.launch.py", launching("Node(package='my_bot', executable='wheel_speed'),"))
    assert told(tmp_path, files, "launch-executable") == []


def test_what_an_included_file_starts_is_told_of_that_file(tmp_path: Path) -> None:
    files = Files.right(NAMES[1])
    files.put("launch/a.launch.py", launching("Node(package='my_bot', executable='talkers'),"))
    including = "IncludeLaunchDescription(PythonLaunchDescriptionSource(os.path.join(share, 'launch', 'a.launch.py'))),"
    files.put("launch/b.launch.py", launching(including))
    (found,) = told(tmp_path, files, "launch-executable")
    assert found.place.startswith("src/my_bot/launch/a.launch.py:")


def grouped(*spaces: str) -> str:
    path = "PythonLaunchDescriptionSource(os.path.join(share, 'launch', 'a.launch.py'))"
    return "".join(
        f"GroupAction([PushRosNamespace('{space}'), IncludeLaunchDescription({path})])," for space in spaces
    )


def started(*names: str, executable: str = "talker") -> str:
    return "".join(f"{SHARED.format(executable).replace('NAME', name)}," for name in names)


AS_VOICE = "name='voice', "


@pytest.mark.parametrize(
    ("keys", "first", "second", "wanted"),
    [
        (["voice"], started(AS_VOICE), grouped("one", "two"), ["write /**/voice: instead of voice:"]),
        (["talker"], started(AS_VOICE), grouped("one"), ["write /**/voice: instead of talker:"]),
        (["talker"], started(AS_VOICE), "", ["write /voice: instead of talker:, or /**: for every node"]),
        (["voice"], started(AS_VOICE, AS_VOICE + "namespace='one', "), "", ["write /**/voice: instead of voice:"]),
        (
            ["talker"],
            started("name='a', ", "name='b', "),
            "",
            ["write /a: and /b: instead of talker:, each with what is below it"],
        ),
        (["/**/voice"], started(AS_VOICE), grouped("one", "two"), []),
        (["/voice", "/one/voice", "/two/voice"], started(AS_VOICE), grouped("one", "two"), []),
        (["/one/voice"], started(AS_VOICE + "namespace='one', ", AS_VOICE + "namespace='two', "), "", []),
    ],
)  # fmt: skip
def test_a_section_serves_every_start(
    tmp_path: Path, keys: list[str], first: str, second: str, wanted: list[str]
) -> None:
    files = Files.right(NAMES[1]).put("launch/a.launch.py", launching(first))
    if second:
        files.put("launch/b.launch.py", launching(second))
    files.put("config/more.yaml", "".join(f"{key}:\n  ros__parameters:\n    period: 3.0\n" for key in keys))
    assert [finding.fix for finding in told(tmp_path, files, "parameter-file-node")] == wanted


@pytest.mark.parametrize(("more", "is_told"), [("", True), (", PushRosNamespace", False)])
def test_a_section_is_compared_though_launch_lacks_a_package(
    tmp_path: Path, more: str, is_told: bool
) -> None:
    text = launching(started(AS_VOICE), "get_package_share_directory('not_here')")
    files = Files.right(NAMES[1]).put("launch/a.launch.py", text.replace(", PushRosNamespace", more))
    files.put("config/more.yaml", "talker:\n  ros__parameters:\n    period: 3.0\n")
    assert [f.fix[:14] for f in told(tmp_path, files, "parameter-file-node")] == ["write /voice: "] * is_told


def test_what_launch_starts_is_known_though_the_text_has_a_fault(tmp_path: Path) -> None:
    words = (
        started(AS_VOICE).replace("NAME", "").replace("name=", "ros_arguments=['--log-level debug'], name=")
    )
    files = Files.right(NAMES[1]).put("launch/a.launch.py", launching(words))
    files.put("config/more.yaml", "talker:\n  ros__parameters:\n    period: 3.0\n")
    assert len(told(tmp_path, files, "parameter-file-node")) == 1
