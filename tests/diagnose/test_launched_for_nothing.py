"""What launch cannot give a program, or never begins: a keyboard, and what waits for an end that does not come."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose.look import Look

LAUNCH, DRIVER = "launch/robot.launch.py", "executable='velocity_publisher'"
ASKING = {
    "in main": ("    name = input('name> ')\n", "", True),
    "of the whole input": ("    for line in sys.stdin:\n        print(line)\n", "", True),
    "a password": ("    word = getpass.getpass()\n", "", True),
    "with its own terminal": ("    name = input('name> ')\n", ", prefix='xterm -e'", False),
    "only at a terminal": ("    if sys.stdin.isatty():\n        name = input('name> ')\n", "", False),
    "where the error is caught": ("    try:\n        name = input()\n    except EOFError:\n        name = 'a'\n", "", False),
    "after what leaves without one": ("    if not sys.stdin.isatty():\n        return\n    name = input('name> ')\n", "", False),
    "after a try that leaves": ("    try:\n        os.get_terminal_size()\n    except OSError:\n        return\n    else:\n        name = input()\n", "", False),
    "where the error is passed over": ("    with contextlib.suppress(EOFError):\n        name = input()\n", "", False),
    "where only an interrupt is caught": ("    try:\n        name = input()\n    except KeyboardInterrupt:\n        return\n", "", True),
    "in a condition": ("    if input('go? ') == 'n':\n        return\n", "", True),
    "in each round": ("    while True:\n        if input('go? ') == 'y':\n            break\n", "", True),
    "nothing": ("    name = 'input'\n", "", False),
}  # fmt: skip
HEAD = "from launch.actions import RegisterEventHandler, Shutdown\nfrom launch.event_handlers import OnProcessExit, OnExecutionComplete\n"
AFTER = "Node(package='my_bot', executable='status_publisher')"
WAITING = {
    "another node": ("OnProcessExit(target_action=driver, on_exit=[after])", "", True),
    "one node alone": ("OnProcessExit(target_action=driver, on_exit=after)", "", True),
    "its completion": ("OnExecutionComplete(target_action=driver, on_completion=[after])", "", True),
    "the end of all": ("OnProcessExit(target_action=driver, on_exit=[Shutdown()])", "", False),
    "itself again": ("OnProcessExit(target_action=driver, on_exit=[driver])", "", False),
    "a program that ends": ("OnProcessExit(target_action=driver, on_exit=[after])", "        raise SystemExit\n", False),
}  # fmt: skip


@pytest.mark.parametrize(("lines", "more", "is_told"), ASKING.values(), ids=ASKING)
def test_a_launched_program_has_no_keyboard(tmp_path: Path, lines: str, more: str, is_told: bool) -> None:
    files = right_workspace().change(
        "driver",
        "import rclpy\n",
        "import contextlib\nimport getpass\nimport os\nimport sys\n\nimport rclpy\n",
    )
    files.change("driver", "def main(args=None):\n", f"def main(args=None):\n{lines}")
    files.change(LAUNCH, DRIVER, f"{DRIVER}{more}")
    look = Look(files.write(tmp_path), loads=True)
    found = [one for one in look.findings if "no keyboard" in one.cause]
    assert len(found) == is_told


@pytest.mark.parametrize(("handler", "end", "is_told"), WAITING.values(), ids=WAITING)
def test_an_end_that_does_not_come(tmp_path: Path, handler: str, end: str, is_told: bool) -> None:
    text = f"""\
from launch import LaunchDescription
from launch_ros.actions import Node
{HEAD}

def generate_launch_description():
    driver = Node(package='my_bot', {DRIVER})
    after = {AFTER}
    return LaunchDescription([driver, RegisterEventHandler({handler})])
"""
    files = right_workspace().put(LAUNCH, text)
    files.change("driver", "        msg = Twist()\n", f"        msg = Twist()\n{end}")
    look = Look(files.write(tmp_path), loads=True)
    assert len([one for one in look.findings if "waits for the end of" in one.cause]) == is_told
