"""Topics and words that do not meet because something else stands in their place."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_text
from ros2lab.diagnose.look import Look


@pytest.mark.parametrize(
    ("sent", "read", "meant"),
    [
        ("/news", "std_msgs/String", "news"),
        ("/news", "std_msgs/msg/String", "news"),
        ("/news", "String", "news"),
        ("/news", "command_callback", "news"),
        ("String", "/orders", "orders"),
        ("/news", "/orders", ""),
        ("std_msgs/String", "/std_msgs/String", ""),
    ],
)
def test_a_topic_that_is_named_after_something_else(tmp_path: Path, sent: str, read: str, meant: str) -> None:
    files = right_workspace().change("node", "'/robot/report'", repr(sent))
    files.change("listener", "'/robot/command'", repr(read))
    found = [f for f in Look(files.write(tmp_path)).findings if f.code == "topic-near-miss"]
    assert [f.fix.split()[1] for f in found] == ([repr(meant)] if meant else [])


@pytest.mark.parametrize(
    ("written", "fix"),
    [
        ("MOVES = [\n    'start'\n    'stop',\n    'turn',\n]", "write `'start',`"),
        ("MOVES = ['turn', 'start' 'stop']", "write `'start', 'stop'`"),
        ("MOVES = {'start' 'stop'}", "write `'start', 'stop'`"),
        ("MOVES = (\n    'stop'\n    'start'\n    'stop',\n)", "write `'stop',` and `'start',`"),
        ("MOVES = ['start' '_slowly', 'stop']", ""),
        ("MOVES = ['start' 'stop', 'x']\nBOTH = 'startstop'", ""),
        ("MOVES = 'start' 'stop'", ""),
        ("MOVES = ['start', 'stop']", ""),
    ],
)
def test_a_comma_that_is_missing_between_two_words(tmp_path: Path, written: str, fix: str) -> None:
    files = right_workspace()
    files.change("listener", "\n\n\nclass", f"\n\n{written}\nWORDS = ('start', 'stop')\n\n\nclass")
    found = [f.fix for f in Look(files.write(tmp_path)).findings if f.code == "comma-missing"]
    assert found == ([fix] if fix else [])


@pytest.mark.parametrize(
    ("typed", "right"),
    [
        ("-n 6", "n:=6"), ("--n 6", "n:=6"), ("-n=6", "n:=6"), ("--n=6", "n:=6"), ("n=6", "n:=6"), ("n 6", "n:=6"),
        ("n: 6", "n:=6"), ("n:= 6", "n:=6"), ("6", "n:=6"), ("-n -6", "n:=-6"), ("--number 6", "n:=6"),
    ],
)  # fmt: skip
def test_a_launch_argument_keeps_its_value(tmp_path: Path, typed: str, right: str) -> None:
    files = right_workspace()
    files.change(
        "launch/robot.launch.py",
        "LaunchDescription([",
        "LaunchDescription([DeclareLaunchArgument('n', default_value='3'),",
    )
    files.change(
        "launch/robot.launch.py", "\n\n\ndef", "\nfrom launch.actions import DeclareLaunchArgument\n\n\ndef"
    )
    said = f"$ ros2 launch my_bot robot.launch.py {typed}\nros2: error: unrecognized arguments: 6\n"
    assert of_text(said, files.write(tmp_path))[0].fix == f"type `ros2 launch my_bot robot.launch.py {right}`"


TRACEBACK = """\
$ ros2 run my_bot LISTENER
Traceback (most recent call last):
  File "src/my_bot/my_bot/feeder.py", line LINE, in take
    CODE
ERROR
"""
FEEDER = """\
ROOMS = [1, 2]


class Feeder:
    index = 0

    def take(self, msg):
        action, amount = msg.data.split()
        if action == 'feed':
            self.total += int(amount)
        elif action == 'reset':
            self.total = ROOMS[self.index]
            print(ROOMS[self.index])
"""


@pytest.mark.parametrize(
    ("old", "new", "fix"),
    [
        ("", "", "write `parts = msg.data.split()` and `action = parts[0]` instead of this line, and `amount = parts[1]` first below `if action == 'feed':`"),
        (", amount =", ", amount, unit =", "`amount, unit = parts[1:]` first below `if action == 'feed':`"),
        ("print(ROOMS[self.index])", "print(amount)", "`if len(parts) == 2:` above this line"),
    ],
)  # fmt: skip
def test_what_only_one_branch_needs_is_taken_there(tmp_path: Path, old: str, new: str, fix: str) -> None:
    assert fix in _stopped(
        tmp_path,
        FEEDER.replace(old, new) if old else FEEDER,
        "msg.data",
        "ValueError: not enough values to unpack (expected 2, got 1)",
    )


def test_an_element_is_mended_on_each_line(tmp_path: Path) -> None:
    fix = _stopped(tmp_path, FEEDER, "= ROOMS[", "IndexError: list index out of range")
    assert fix.startswith("write ROOMS[self.index % len(ROOMS)] on lines 12 and 13 to start again")


def _stopped(folder: Path, text: str, where: str, error: str) -> str:
    """Return the fix of an error in a file of a workspace."""
    files = right_workspace()
    files.texts["src/my_bot/my_bot/feeder.py"] = text
    root = files.write(folder)
    line, code = next((n, code) for n, code in enumerate(text.splitlines(), 1) if where in code)
    said = (
        TRACEBACK.replace("line LINE", f"line {line}").replace("CODE", code.strip()).replace("ERROR", error)
    )
    said = said.replace('"src', f'"{root}/src').replace("LISTENER", "feeder")
    return of_text(said, root)[0].fix
