"""What a launch file runs only later, in a timer or an event handler, and packages that are not here."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.look import Look

LAUNCH = "launch/robot.launch.py"
IMPORTS = """\
from launch.actions import LogInfo, RegisterEventHandler, TimerAction
from launch.event_handlers import OnProcessExit, OnProcessStart, OnShutdown
from launch.substitutions import Command, EnvironmentVariable, FindExecutable, LaunchConfiguration
from launch_ros.substitutions import FindPackageShare
"""


def told(folder: Path, action: str, *, depends: str = "") -> list[Finding]:
    """Return what is said of a launch file with one more action."""
    files = right_workspace().change(LAUNCH, "import os\n", f"import os\n{IMPORTS}")
    files.change(
        LAUNCH, "    return LaunchDescription([", f"    return LaunchDescription([\n        {action},"
    )
    if depends:
        files.change(
            "package.xml", "  <depend>rclpy", f"  <exec_depend>{depends}</exec_depend>\n  <depend>rclpy"
        )
    files.change(LAUNCH, "\n\ndef generate", "\n\n# 'their_arm' and 'nav2_msgs' move the arm\ndef generate")
    return [found for found in of_workspace(files.write(folder)) if found.code in (SAID, "launch-package")]


def test_what_an_included_file_lacks_is_told_there(tmp_path: Path) -> None:
    files = right_workspace()
    body = "from launch import LaunchDescription\nfrom launch.actions import IncludeLaunchDescription\nfrom launch_ros.actions import Node\nfrom launch_ros.substitutions import FindPackageShare\n\n\ndef generate_launch_description():\n    return LaunchDescription([ACTION])\n"
    files.put(
        "launch/inner.launch.py",
        body.replace("ACTION", "Node(package=FindPackageShare('their_arm'), executable='a')"),
    )
    outer = "IncludeLaunchDescription([FindPackageShare('my_bot'), '/launch/inner.launch.py'])"
    files.put("launch/outer.launch.py", body.replace("ACTION", outer))
    found = [one.place for one in of_workspace(files.write(tmp_path)) if one.code == "launch-package"]
    assert found == ["src/my_bot/launch/inner.launch.py:8"]


def logs(what: str) -> str:
    return f"LogInfo(msg=['it is ', {what}])"


LATER = [
    "TimerAction(period=2.0, actions=[{}])",
    "RegisterEventHandler(OnProcessExit(on_exit=[{}]))",
    "RegisterEventHandler(OnProcessStart(on_start=[{}]))",
    "RegisterEventHandler(OnShutdown(on_shutdown=[{}]))",
    "TimerAction(period=1.0, actions=[TimerAction(period=2.0, actions=[{}])])",
]
OF_THE_MACHINE = [
    "EnvironmentVariable('NOT_SET_HERE')",
    "FindPackageShare('their_arm')",
    "FindExecutable(name='their_program')",
    "Command(['their_program ', 'robot.xacro'])",
]


@pytest.mark.parametrize(
    ("later", "what"),
    [(LATER[0], what) for what in OF_THE_MACHINE]
    + [(later, OF_THE_MACHINE[0]) for later in LATER[1:]]
    + [("{}", what) for what in OF_THE_MACHINE if "Package" not in what],
)
def test_what_only_the_machine_lacks_is_not_told(tmp_path: Path, later: str, what: str) -> None:
    assert told(tmp_path, later.format(logs(what))) == []


@pytest.mark.parametrize("later", [LATER[0], LATER[1]])
def test_a_slip_in_what_runs_later_is_told(tmp_path: Path, later: str) -> None:
    (found,) = told(tmp_path / "a", later.format(logs("FindPackageShare('my_bto')")))
    assert (found.code, found.fix) == ("launch-package", "write my_bot instead of my_bto")
    assert "cannot load" not in found.cause
    (found,) = told(tmp_path / "b", later.format(logs("LaunchConfiguration('speed')")))
    assert "speed" in found.cause


@pytest.mark.parametrize(
    ("name", "depends", "fix"),
    [
        ("nav2_msgs", "nav2_msgs", "install it (sudo apt install ros-jazzy-nav2-msgs), or put its source into src"),
        ("their_arm", "their_arm", "install it (sudo apt install ros-jazzy-their-arm), if `apt-cache policy ros-jazzy-their-arm` names a version, or put its source into src; if their_arm is misspelt, correct it"),
        ("tf2_msgs_", "", "write tf2_msgs instead of tf2_msgs_"),
        ("their_arm", "", "install it (sudo apt install ros-jazzy-their-arm), if `apt-cache policy ros-jazzy-their-arm` names a version, or put its source into src; if their_arm is misspelt, correct it"),
    ],
)  # fmt: skip
def test_a_right_name_is_not_to_be_corrected(tmp_path: Path, name: str, depends: str, fix: str) -> None:
    (found,) = told(tmp_path, logs(f"FindPackageShare('{name}')"), depends=depends)
    assert found.code == "launch-package"
    assert found.fix == fix
    assert found.place.endswith(f":{line_of(tmp_path, name)}")


def line_of(folder: Path, name: str) -> int:
    """Return the line of the action that names a package, below a comment that names it, too."""
    (path,) = folder.rglob("robot.launch.py")
    lines = path.read_text().splitlines()
    return next(n for n, line in enumerate(lines, 1) if f"FindPackageShare('{name}')" in line)


def test_what_an_included_file_lacks_is_told_of_that_file_alone(tmp_path: Path) -> None:
    files = right_workspace()
    text = files.texts[files.path(LAUNCH)]
    joined = "PathJoinSubstitution([FindPackageShare('my_bot'), 'launch', 'robot.launch.py'])"
    imports = "from launch import LaunchDescription\nfrom launch.actions import IncludeLaunchDescription\nfrom launch.substitutions import PathJoinSubstitution\nfrom launch_ros.substitutions import FindPackageShare\n"
    outer = f"{imports}\n\ndef generate_launch_description():\n    return LaunchDescription([IncludeLaunchDescription({joined})])\n"
    lacking = "from ament_index_python.packages import get_package_share_directory as share\nJOY = share('teleop_twist_joy')\n"
    files.put(LAUNCH, f"{lacking}{text}").put("launch/all.launch.py", outer)
    found = [one for one in of_workspace(files.write(tmp_path)) if one.code == "launch-package"]
    assert [one.place for one in found] == ["src/my_bot/launch/robot.launch.py:2"]


@pytest.mark.parametrize(
    ("row", "read"),
    [
        ("('share/my_bot', ['table/row.json'])", "row.json"),
        ("('share/my_bot/config', ['table/row.json'])", "config/row.json"),
        ("('share/my_bot/rows/of/today', ['table/row.json'])", "rows/of/today/row.json"),
        ("('share/my_bot', glob('table/*.json'))", "row.json"),
        ("('share/my_bot/table', ['table/row.json'])", "table/row.json"),
    ],
)
def test_a_file_is_read_where_setup_installs_it(tmp_path: Path, row: str, read: str) -> None:
    files = right_workspace().put("table/row.json", '{"rate": 2.0}').put("config/other.yaml", "{}\n")
    files.change("setup.py", "data_files=[", f"data_files=[\n        {row},")
    files.change("setup.py", "from setuptools", "from glob import glob\n\nfrom setuptools")
    head = "import json\nfrom ament_index_python.packages import get_package_share_path\nROW = json.loads((get_package_share_path('my_bot') / 'PATH').read_text())\n"
    files.put(LAUNCH, head.replace("PATH", read) + files.texts[files.path(LAUNCH)])
    (file,) = Look(files.write(tmp_path), loads=True).launch_files
    assert file.is_loaded
