"""Commands that a launch file starts and that end with an error: the word of the file that is wrong."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text

DICTIONARY = "The passed value needs to be a dictionary in YAML format, such as '{name: 1.0}' (with a space after each colon)"
FILE = """\
import os
from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch.substitutions import FindExecutable, LaunchConfiguration

LAMP = '/lights'


def generate_launch_description():
    return LaunchDescription([
        ExecuteProcess(
            name='lights_on',
            cmd=CMD,
            output='screen',
        ),
    ])
"""
PUB = "['ros2', 'topic', 'pub', '--once', '/lights', 'std_msgs/msg/Bool', LAST]"
CALL = "['ros2', 'service', 'call', '/lamp', 'std_srvs/srv/SetBool', LAST]"


def told(
    root: Path, written: str, shown: str, said: str = DICTIONARY, name: str = "lights.launch.py"
) -> list[Finding]:
    """Return what is told of a command that has died, as launch shows it, after what it has said itself."""
    files = Files.right(NAMES[1])
    files.put(f"launch/{name}", written)
    files.write(root)
    text = (
        f"$ ros2 launch my_bot {name}\n[INFO] [lights_on-1]: process started with pid [7]\n[lights_on-1] {said}\n"
        f"[ERROR] [lights_on-1]: process has died [pid 7, exit code 1, cmd '{shown}'].\n"
    )
    return of_text(text, root)


SHOWN_PUB, SHOWN_CALL = (
    "topic pub --once /lights std_msgs/msg/Bool",
    "service call /lamp std_srvs/srv/SetBool",
)


@pytest.mark.parametrize(
    ("cmd", "last", "shown", "fix"),
    [
        (PUB, '"data: true"', SHOWN_PUB, "write `'data: true'` instead of `'\"data: true\"'`"),
        (CALL, "'data: true'", SHOWN_CALL, "write `'data: true'` instead of `\"'data: true'\"`"),
        (PUB, '"{data: true}"', SHOWN_PUB, "write `'{data: true}'` instead of"),
        (PUB, "data:true", SHOWN_PUB, "write `'{data: true}'` instead of `'data:true'`"),
        (CALL, "data:true", SHOWN_CALL, "write `'{data: true}'` instead of `'data:true'`"),
        (PUB, '"data:true"', SHOWN_PUB, "write `'{data: true}'` instead of `'\"data:true\"'`"),
        (PUB.replace("'/lights'", "LAMP"), '"data: true"', SHOWN_PUB, "write `'data: true'`"),
        (PUB.replace("'/lights'", "LaunchConfiguration('lamp')"), '"data: true"', SHOWN_PUB, "write `'data: true'`"),
        (PUB.replace("'ros2'", "FindExecutable(name='ros2')"), '"data: true"', SHOWN_PUB, "write `'data: true'`"),
        (PUB.replace("std_msgs/msg/", ""), "data: true", SHOWN_PUB.replace("std_msgs/msg/", ""), "write `'std_msgs/msg/Bool'` instead of `'Bool'`"),
        ("[['ros2 topic pub --once /lights std_msgs/msg/Bool ', LAST]], shell=True", "data:true", SHOWN_PUB, "write `cmd=[\"ros2 topic pub --once /lights std_msgs/msg/Bool '{data: true}'\"]`"),
    ],
)  # fmt: skip
def test_the_word_that_a_command_cannot_read_is_told(
    tmp_path: Path, cmd: str, last: str, shown: str, fix: str
) -> None:
    """With the file's own line and words, and as Python that can be read."""
    written = FILE.replace("CMD", cmd.replace("LAST", repr(last)))
    start = "/venv/bin/ros2" if "FindExecutable" in cmd else "ros2"
    found = told(tmp_path, written, f"{start} {shown} {last}")[0]
    assert found.code == "launch-argument"
    assert found.place.endswith("lights.launch.py:13")
    assert fix in found.fix
    for piece in re.findall(r"`([^`]+)`", found.fix):
        ast.parse(piece)


@pytest.mark.parametrize(
    ("words", "said", "fix"),
    [
        (["ls", '"/tmp/my dir"'], """ls: cannot access '"/tmp/my dir"': No such file or directory""", "write `'/tmp/my dir'` instead of `'\"/tmp/my dir\"'`"),
        (["ls", "$HOME/lights"], "ls: cannot access '$HOME/lights': No such file or directory", "write `os.path.expandvars('$HOME/lights')` instead"),
        (["ls", "~/lights"], "ls: cannot access '~/lights': No such file or directory", "write `os.path.expanduser('~/lights')` instead"),
        (["ls", "lights", "|", "sort", "my file"], "ls: cannot access '|': No such file or directory", "write `cmd=[\"ls lights | sort 'my file'\"], shell=True`"),
        (["ls", "lights", ">", "out.txt"], "ls: cannot access '>': No such file or directory", "write `cmd=['ls lights > out.txt'], shell=True`"),
    ],
)  # fmt: skip
def test_what_only_a_shell_does_is_told(tmp_path: Path, words: list[str], said: str, fix: str) -> None:
    found = told(tmp_path, FILE.replace("CMD", repr(words)), " ".join(words), said)[0]
    assert "No shell reads cmd" in found.cause
    assert fix in found.fix


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["ros2", "param", "set", "/lamp", "name", '"5"'], "Node not found"),  # a text in YAML
        (["ros2", "topic", "pub", "--once", "/lights", "std_msgs/msg/Bool", "data: true"], "the network is down"),
        (["ls", "lights"], "ls: cannot access 'lights': No such file or directory"),
    ],
)  # fmt: skip
def test_right_words_are_not_blamed(tmp_path: Path, words: list[str], said: str) -> None:
    found = told(tmp_path, FILE.replace("CMD", repr(words)), " ".join(words), said)
    assert not [finding for finding in found if finding.code == "launch-argument"]


@pytest.mark.parametrize(
    ("last", "shown", "fix"),
    [
        ("'data: true'", "data: true", ""),  # there, launch takes the quotes away
        ("data:true", "data:true", "'{data: true}'"),
        ("'data:true'", "data:true", "'{data: true}'"),
    ],
)
def test_quotes_are_right_in_xml(tmp_path: Path, last: str, shown: str, fix: str) -> None:
    cmd = f"ros2 topic pub --once /lights std_msgs/msg/Bool {last}"
    written = f'<launch>\n  <executable name="lights_on" cmd="{cmd}"/>\n</launch>\n'
    found = told(tmp_path, written, f"ros2 {SHOWN_PUB} {shown}", name="lights.launch.xml")
    blamed = [finding for finding in found if finding.code == "launch-argument"]
    assert bool(blamed) == bool(fix)
    for finding in blamed:
        assert finding.place.endswith("lights.launch.xml:2")
        assert fix in finding.fix


@pytest.mark.parametrize(
    ("said", "place"),
    [
        ("[ERROR] [xterm9-1]: exception occurred while executing process: [Errno 2] No such file or directory: 'xterm9'", "crane.launch.xml:2"),
        ("'rviz9' cannot be started: No such file or directory: 'rviz9'", "crane.launch.xml:3"),
        ("/usr/bin/env: \u2018python9\u2019: No such file or directory", ""),
        ("timeout: failed to run command \u2018stress9\u2019: No such file or directory", ""),
        ('Traceback (most recent call last):\n  File "/usr/lib/python3.12/subprocess.py", line 1955, in _execute_child\n    raise child_exception_type(errno_num, err_msg, err_filename)\nFileNotFoundError: [Errno 2] No such file or directory: \'xterm9\'', "crane.launch.xml:2"),
        ("bash: xterm9: No such file or directory", None),
        ("FileNotFoundError: [Errno 2] No such file or directory: 'xterm9'", None),
        ("[ERROR] [xterm9-1]: exception occurred while executing process: [Errno 2] No such file or directory: './xterm9'", None),
    ],
)  # fmt: skip
def test_a_bare_name_that_could_not_be_started_is_a_program(
    tmp_path: Path, said: str, place: str | None
) -> None:
    launch = '<launch>\n  <node pkg="p" exec="e" launch-prefix="xterm9 -e"/>\n  <executable cmd="rviz9 -d x"/>\n</launch>\n'
    found = of_text(said, Files.right(NAMES[0]).put("launch/crane.launch.xml", launch).write(tmp_path))[0]
    assert found.cause.startswith("There is no program ") is (place is not None)
    assert place is None or found.place.rpartition("/")[2] == place


def test_a_command_in_one_text_is_no_program(tmp_path: Path) -> None:
    said = "[ERROR] [ls -l-1]: exception occurred while executing process: [Errno 2] No such file or directory: 'ls -l'"
    (found, *_) = of_text(said, Files.right(NAMES[0]).write(tmp_path))
    assert found.cause == "There is no program 'ls -l': the whole text is taken for the name of a program."
    assert found.fix.endswith(" one by one: ['ls', '-l']")
