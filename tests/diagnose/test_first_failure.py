"""The first failure of a terminal is explained, and the words that were typed are compared with the workspace."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text, of_workspace
from ros2lab.diagnose.explaining.needed import of_needed
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import read_error

USAGE = "usage: colcon [-h] [--log-base LOG_BASE]\n              {build,list} ...\ncolcon: error: "
AFTER = (
    "\n$ source install/setup.bash\nbash: install/setup.bash: No such file or directory\n"
    "$ ros2 run my_bot talker\nPackage 'my_bot' not found\n"
)
BUILT = "$ colcon build\nStarting >>> my_bot\nFinished <<< my_bot [2s]\n\nSummary: 1 package finished [3s]\n$ source install/setup.bash\n"


def first(text: str, files: Files, folder: Path) -> Finding:
    return of_text(text, files.write(folder))[0]


@pytest.mark.parametrize(
    ("typed", "said", "fix"),
    [
        ("colcon build my_bot", "unrecognized arguments: my_bot", "colcon build --packages-select my_bot"),
        ("colcon build src/my_bot", "unrecognized arguments: src/my_bot", "colcon build --packages-select my_bot"),
        ("colcon build ./src/my_bot/", "unrecognized arguments: ./src/my_bot/", "colcon build --packages-select my_bot"),
        ("colcon build --packages my_bot", "ambiguous option: --packages could match --packages-select", "colcon build --packages-select my_bot"),
        ("colcon build --package-select my_bot", "unrecognized arguments: --package-select my_bot", "colcon build --packages-select my_bot"),
        ("colcon build --symlink-install my_bot", "unrecognized arguments: my_bot", "colcon build --symlink-install --packages-select my_bot"),
    ],
)  # fmt: skip
def test_a_build_that_was_refused_is_why_nothing_is_found(
    tmp_path: Path, typed: str, said: str, fix: str
) -> None:
    found = first(f"$ {typed}\n{USAGE}{said}{AFTER}", Files.right(NAMES[1]), tmp_path)
    assert (found.code, found.fix) == ("typed-wrong", f"type `{fix}`")


def test_a_later_build_that_succeeded_counts(tmp_path: Path) -> None:
    text = f"$ colcon build my_bot\n{USAGE}unrecognized arguments: my_bot\n{BUILT}$ ros2 run my_bot tlaker\nNo executable found\n"
    assert "talker" in first(text, Files.right(NAMES[1]), tmp_path).fix


def with_tools(depend: str = "") -> Files:
    """Return a workspace with a second package my_tools, on which my_bot depends if that is said."""
    files = Files.right(NAMES[1])
    for path, text in {**files.texts}.items():
        if "/launch/" not in path and "/config/" not in path:
            files.texts[path.replace("my_bot", "my_tools")] = text.replace("my_bot", "my_tools")
    manifest = f"src/{NAMES[1].package}/package.xml"
    files.texts[manifest] = files.texts[manifest].replace("  <export>", f"{depend}  <export>")
    launch = f"src/{NAMES[1].package}/launch/robot.launch.py"
    files.texts[launch] = files.texts[launch].replace(
        "Node(package='my_bot', executable='ears')", "Node(package='my_tools', executable='ears')"
    )
    return files


LACKS = "ERROR:colcon.colcon_ros.task.ament_python.build:Failed to find the following files:\n- /ws/install/my_tools/share/my_tools/package.sh\nCheck that the following packages have been built:\n- my_tools\nFailed   <<< my_bot [0.07s, exited with code 1]\n\nSummary: 0 packages finished [0.68s]\n  1 package failed: my_bot\n"


def test_what_a_build_lacks_is_built_with_it(tmp_path: Path) -> None:
    text = f"$ colcon build --symlink-install --packages-select my_bot\nStarting >>> my_bot\n[1.1s] {LACKS}$ source install/setup.bash\n$ ros2 run my_bot talker\nPackage 'my_bot' not found\n"
    found = first(text, with_tools("  <exec_depend>my_tools</exec_depend>\n"), tmp_path)
    assert found.fix == "colcon build --symlink-install --packages-up-to my_bot"


def test_what_is_in_no_workspace_here_must_be_sourced(tmp_path: Path) -> None:
    text = f"$ colcon build\nStarting >>> my_bot\n[1.1s] {LACKS}"
    assert "source the install/setup.bash" in first(text, Files.right(NAMES[1]), tmp_path).fix


NOT_THERE = "$ ros2 launch my_bot robot.launch.py\n[ERROR] [launch]: Caught exception in launch (see debug for traceback): Caught multiple exceptions when trying to load file of format [py]:\n - PackageNotFoundError: \"package 'my_tools' not found, searching: ['/ws/install/my_bot']\"\n - InvalidFrontendLaunchFileError: The launch file may have a syntax error\n"


def test_a_package_that_is_used_but_not_declared_is_why_it_was_not_built(tmp_path: Path) -> None:
    text = BUILT.replace("colcon build", "colcon build --packages-up-to my_bot") + NOT_THERE
    found = first(text, with_tools(), tmp_path)
    assert found.code == "dependency-undeclared"
    assert found.fix.startswith("add <exec_depend>my_tools</exec_depend> to src/my_bot/package.xml")


def test_a_package_that_was_not_selected_is_built_with_its_user(tmp_path: Path) -> None:
    text = BUILT.replace("colcon build", "colcon build --packages-select my_bot") + NOT_THERE
    found = first(text, with_tools("  <exec_depend>my_tools</exec_depend>\n"), tmp_path)
    assert found.fix.startswith("colcon build --packages-up-to my_bot")


SPEAK = ("'talker = ", "'speak = ")


@pytest.mark.parametrize(
    ("typed", "fix"),
    [
        ("my_bot talker.py", "my_bot speak"),
        ("my_bot talker --ros-args -p period:=1.0", "my_bot speak --ros-args -p period:=1.0"),
        ("my_bot my_bot/talker.py", "my_bot speak"),
        ("my_bot my_bot.talker:main", "my_bot speak"),
        ("my_bot Talker", "my_bot speak"),
        ("my_bot ears.py", "my_bot ears"),
    ],
)
def test_an_executable_is_named_by_its_own_name(tmp_path: Path, typed: str, fix: str) -> None:
    files = Files.right(NAMES[1]).change("setup.py", *SPEAK)
    found = first(f"{BUILT}$ ros2 run {typed}\nNo executable found\n", files, tmp_path)
    assert (found.code, found.fix) == ("executable-missing", f"type `ros2 run {fix}`")


def test_two_executables_of_a_file_are_both_offered(tmp_path: Path) -> None:
    files = Files.right(NAMES[1]).change("setup.py", "'talker = ", "'loud = my_bot.talker:main', 'speak = ")
    found = first(f"{BUILT}$ ros2 run my_bot talker\nNo executable found\n", files, tmp_path)
    assert found.fix == "type `ros2 run my_bot loud`, or `ros2 run my_bot speak`"


def test_a_launch_file_names_an_executable_by_its_own_name(tmp_path: Path) -> None:
    files = Files.right(NAMES[1]).change("setup.py", *SPEAK)
    found = first(
        "$ colcon list\nexecutable 'talker' not found on the libexec directory '/x'\n", files, tmp_path
    )
    assert found.fix == "write speak instead of talker"


@pytest.mark.parametrize("options", ["", " --ros-args -p period:=1.0"])
@pytest.mark.parametrize("written", ["talker", "talkr", "talker.py"])
def test_swapped_names_are_put_in_order(tmp_path: Path, written: str, options: str) -> None:
    text = f"{BUILT}$ ros2 run {written} my_bot{options}\nPackage '{written}' not found\n"
    found = first(text, Files.right(NAMES[1]), tmp_path)
    assert "swapped" in found.cause
    assert found.fix == f"type `ros2 run my_bot talker{options}`"


def test_a_terminal_whose_folder_is_gone_gets_a_sentence(tmp_path: Path) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    program = "import os, sys; os.rmdir(os.getcwd()); sys.argv = ['ros2lab', 'diagnose']; from ros2lab.cli import main; main()"
    environ = os.environ | {"PWD": str(gone), "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=gone,
        env=environ,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.returncode == 2
    assert f"{gone} no longer exists" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("between", [",", ";", ", ", " , "])
def test_package_names_are_separated_by_spaces(tmp_path: Path, between: str) -> None:
    typed = f"colcon build --packages-select my_bot{between}my_tools"
    warning = (
        f"WARNING:colcon.colcon_core.package_selection:ignoring unknown package 'my_bot{between.strip()}'"
    )
    found = first(
        f"$ {typed}\n{warning} in --packages-select\n\nSummary: 0 packages finished [0.6s]{AFTER}",
        with_tools(),
        tmp_path,
    )
    assert (found.code, found.fix.partition("`,")[0].strip("`")) == (
        "typed-wrong",
        "type `colcon build --packages-select my_bot my_tools",
    )


def test_a_launch_file_that_is_started_by_its_path_need_not_be_installed(tmp_path: Path) -> None:
    files = Files.right(NAMES[1])
    launch = f"src/{NAMES[1].package}/launch/robot.launch.py"
    files.texts[f"src/{NAMES[1].package}/tools/robot_too.launch.py"] = files.texts[launch]
    root = files.write(tmp_path)
    by_name, by_path = (
        {
            finding.code
            for finding in of_needed(
                of_workspace(root), read_error(f"$ ros2 launch {words}\n[INFO] on\n"), Look(root)
            )
        }
        for words in ("my_bot robot_too.launch.py", f"src/{NAMES[1].package}/tools/robot_too.launch.py")
    )
    assert "not-in-data-files" in by_name
    assert "not-in-data-files" not in by_path
