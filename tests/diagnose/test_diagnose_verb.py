"""The command `ros2lab diagnose`."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from mistakes import remove
from typer.testing import CliRunner
from workspace_files import NAMES, Files

from deadlines import DEADLINE
from ros2lab import domain_lease, trial
from ros2lab.cli import app
from ros2lab.diagnose.explaining.steps import go_step_by_step
from ros2lab.diagnose.finding import Finding, merged
from ros2lab.diagnose.net import STRICT


def typed(*arguments: str, folder: Path, text: str = "") -> subprocess.CompletedProcess[str]:
    """Run the command as a student's shell does."""
    command = [str(Path(sys.executable).with_name("ros2lab")), "diagnose", *arguments]
    return subprocess.run(
        command,
        cwd=folder,
        input=text,
        env={**os.environ, "COLUMNS": "100"},
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=False,
    )


def run(*arguments: str, folder: Path, text: str = "") -> subprocess.CompletedProcess[str]:
    """Do what the command does in this process, which has imported what that needs."""
    command = ["diagnose", *arguments]
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        done = CliRunner().invoke(app, command, input=text, env={"COLUMNS": "100"}, catch_exceptions=False)
    return subprocess.CompletedProcess(command, done.exit_code, done.stdout, done.stderr)


def test_a_right_workspace_ends_with_0(tmp_path: Path) -> None:
    """From a folder inside it, too."""
    root = Files.right(NAMES[0]).write(tmp_path / "ws")
    for arguments, folder in (
        ((str(root),), tmp_path),
        ((), root),
        ((), root / "src/robot_controller/launch"),
    ):
        done = run(*arguments, folder=folder)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.startswith("Nothing was found. It looked at 5 files of robot_controller, ")
        assert "it cannot tell what the nodes do at run time" in done.stdout
    done = typed("--json", folder=root)
    assert (done.returncode, json.loads(done.stdout)) == (0, [])


def test_a_launch_file_that_could_not_be_loaded_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("ros2lab.diagnose.launching.launch_child.LONGEST", 1)
    waits = "import time\n\ntime.sleep(1000)\n"
    files = Files.right(NAMES[0]).change(
        "launch/robot.launch.py", "from launch import", f"{waits}from launch import"
    )
    root = files.write(tmp_path / "ws")
    said = run(str(root), folder=tmp_path).stdout
    assert "robot.launch.py only the text, because launch could not load it by itself" in said


def test_a_text_without_an_error_leads_to_the_files(tmp_path: Path) -> None:
    """A node that runs and does nothing is explained by its files, or it is said what was looked at."""
    files = Files.right(NAMES[0])
    root = files.write(tmp_path)
    text = "$ ros2 run robot_controller velocity_publisher\n[INFO] [driver]: ready\n^C"
    said = run("-", folder=root, text=text)
    assert said.returncode == 0
    assert "robot_controller" in said.stdout
    assert "starting with the command" in said.stdout
    files.change("driver", "    rclpy.spin(node)\n", "").write(root)
    said = run("-", folder=root, text=text)
    assert said.returncode == 1
    assert said.stdout.startswith("spin-missing")


def test_an_empty_workspace_is_not_called_right(tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    assert "no package" in run(folder=tmp_path).stdout


def test_a_fault_ends_with_1(tmp_path: Path) -> None:
    files = Files.right(NAMES[0])
    remove("setup.cfg")(files)
    root = files.write(tmp_path)
    done = typed(str(root), "--json", folder=tmp_path)
    assert done.returncode == 1
    (finding,) = json.loads(done.stdout)
    assert list(finding) == ["code", "cause", "place", "fix"]
    assert finding["code"] == "setup-cfg-missing"
    done = run(folder=root)
    assert done.returncode == 1
    assert "setup-cfg-missing" in done.stdout


def test_where_what_runs_is_a_copy_a_build_is_told(tmp_path: Path) -> None:
    """Beside the fix, and not before it is asked for."""
    files = Files.right(NAMES[0])
    files.change("robot_controller/status_publisher.py", "super().__init__(", "super().__int__(")
    root = files.write(tmp_path)
    told = "after a change, build again: colcon build --packages-select robot_controller"
    assert told not in run(folder=root).stdout
    prefix = root / "install/robot_controller"
    marker = prefix / "share/ament_index/resource_index/packages/robot_controller"
    marker.parent.mkdir(parents=True)
    marker.touch()
    package = root / "src/robot_controller/robot_controller"
    shutil.copytree(package, prefix / "lib/python3.12/site-packages/robot_controller")
    assert told in run(folder=root).stdout
    assert told in run("--up-to", "fix", folder=root).stdout
    assert told not in run("--up-to", "place", folder=root).stdout


def test_what_reading_finds_is_told_where_nothing_can_be_run(tmp_path: Path) -> None:
    """A workspace that is not built has nothing to run; the answer is the list that was asked for all the same."""
    files = Files.right(NAMES[0])
    remove("setup.cfg")(files)
    done = run("--run", "--json", folder=files.write(tmp_path))
    assert done.returncode == 1
    assert "setup-cfg-missing" in [finding["code"] for finding in json.loads(done.stdout)]


@pytest.mark.parametrize("error", [domain_lease.NoDomainError("All are taken."), TypeError("a rule")])
def test_what_reading_finds_is_told_where_a_run_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    """Where no domain is free, and where a rule of ours fails."""

    def fail(*_given: object) -> None:
        raise error

    monkeypatch.setattr(trial, "try_out", fail)
    monkeypatch.delenv(STRICT, raising=False)
    files = Files.right(NAMES[0])
    remove("setup.cfg")(files)
    done = run("--run", folder=files.write(tmp_path))
    assert (done.returncode, "Traceback" in done.stdout + done.stderr) == (1, False)
    assert "setup-cfg-missing" in done.stdout
    assert ("All are taken." in done.stderr) is isinstance(error, RuntimeError)
    assert ("rules failed" in " ".join(done.stdout.split())) is isinstance(error, TypeError)


def test_a_text_is_explained(tmp_path: Path) -> None:
    done = typed("-", "--json", folder=tmp_path, text="ModuleNotFoundError: No module named 'rospy'\n")
    assert (done.returncode, [finding["code"] for finding in json.loads(done.stdout)]) == (1, ["ros1-import"])
    assert run("-", folder=tmp_path, text="").returncode == 0


@pytest.mark.parametrize("arguments", [("/no/such/folder",), ()])
def test_nothing_to_look_at_ends_with_2(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    done = typed(*arguments, folder=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert done.stderr.startswith("There is no ")


def test_of_a_file_it_is_said_how_its_text_is_passed_on(tmp_path: Path) -> None:
    (tmp_path / "what I saw.txt").write_text("ModuleNotFoundError: No module named 'rospy'\n")
    done = typed("what I saw.txt", folder=tmp_path)
    assert done.returncode == 2
    told = done.stderr.strip().partition(": ros2lab ")[2]
    assert told == "diagnose - < 'what I saw.txt'"


def test_the_help_tells_the_exit_codes(tmp_path: Path) -> None:
    text = " ".join(run("--help", folder=tmp_path).stdout.split())
    assert "exit code is 0 if nothing was found" in text


def test_it_says_no_more_than_it_is_asked_for(tmp_path: Path) -> None:
    """Of the likeliest fault: its cause, then its place, then its fix."""
    files = Files.right(NAMES[0])
    remove("setup.cfg")(files)
    root = files.write(tmp_path)
    whole = json.loads(run("--json", folder=root).stdout)[0]
    for step, hidden, more in (
        ("cause", ("place", "fix"), "For the place, add --up-to place."),
        ("place", ("fix",), "For the fix, add --up-to fix."),
        ("fix", (), ""),
    ):
        (finding,) = json.loads(run("--json", "--up-to", step, folder=root).stdout)
        assert finding == {**whole, **dict.fromkeys(hidden, "")}
        said = run("--up-to", step, folder=root)
        assert said.returncode == 1
        assert whole["cause"] in said.stdout
        assert (whole["fix"] in said.stdout) == (step == "fix")
        assert more in said.stdout


def test_in_a_workspace_of_exercises_it_says_the_cause_alone(tmp_path: Path) -> None:
    """Of the workspace, of a package in it, and of an error's text; until it is asked for more."""
    files = Files.right(NAMES[0])
    remove("setup.cfg")(files)
    root = files.write(tmp_path)
    go_step_by_step(root)
    rospy = "ModuleNotFoundError: No module named 'rospy'\n"
    for arguments, text in (((), ""), (("src/robot_controller",), ""), (("-",), rospy)):
        said = run(*arguments, folder=root, text=text)
        assert said.stdout.count("\n") == 2
        assert "--up-to" in said.stdout
        assert "fix: " in run(*arguments, "--up-to", "fix", folder=root, text=text).stdout
    assert "fix: " in run("-", folder=tmp_path.parent, text=rospy).stdout
    traceback = f'Traceback (most recent call last):\n  File "{root}/src/node.py", line 3, in main\n{rospy}'
    assert "fix: " not in run("-", folder=tmp_path.parent, text=traceback).stdout


def test_what_is_quoted_gives_a_terminal_no_codes(tmp_path: Path) -> None:
    """Of a file, of an error's text, and of a folder's name, which is no markup either."""
    root = (
        Files.right(NAMES[0])
        .change("setup.py", "name=package_name", "name='\x1b[2J'")
        .write(tmp_path / "[/x]")
    )
    error = "ModuleNotFoundError: No module named '\x9b2Jrclppy\u202e'\n"
    for arguments, text in (((), ""), (("-",), error), (("-",), "all is well")):
        done = run(*arguments, folder=root, text=text)
        assert done.stderr == ""
        assert not {"\x1b", "\x9b", "\u202e"} & {*done.stdout}


def test_what_is_the_same_on_several_lines_is_told_once() -> None:
    one = Finding("message-field", "Twist has no field x.", "src/a.py:3", "write linear.x")
    same, other = replace(one, place="src/a.py:7"), replace(one, place="src/b.py:7")
    bare = Finding("not-built", "It is not built.", "", "build it")
    assert merged([one, same, bare, other]) == [
        replace(one, fix="write linear.x; likewise on line 7"),
        bare,
        other,
    ]
    without = [replace(finding, fix="") for finding in (one, same, replace(one, place="src/a.py:9"))]
    assert merged(without) == [replace(one, fix="likewise on lines 7 and 9")]
