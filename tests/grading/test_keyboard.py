"""A program that reads a keyboard is given one, so that what it does behind that is seen."""

from __future__ import annotations

import math
import os
import select
import subprocess
import sys
from pathlib import Path

import pytest

from ros2lab.grading.evidence import KEYBOARD, Build, Executable, Files, Run
from ros2lab.grading.judging.player import finds_no_keyboard, is_for_want
from ros2lab.grading.questions.answer import last_word
from ros2lab.grading.receiving.submission import Submission
from ros2lab.grading.sandbox.worlds import FILES, World, underlay
from ros2lab.grading.watching.keyboard import MOST_RUNS, Keyboard, Search, answers
from ros2lab.grading.watching.observe import SHOWN, Observer
from ros2lab.grading.watching.rounds import watch

BEGIN = "import sys\n"  # what ends at its question has imported nothing that takes long
REST = """
import rclpy
from geometry_msgs.msg import Twist
rclpy.init()
node = rclpy.create_node("velocity_publisher")
publisher = node.create_publisher(Twist, "/cmd_vel", 10)
timer = node.create_timer(0.1, lambda: publisher.publish(Twist()))
rclpy.spin(node)
"""
BROKEN = "raise AttributeError('it never worked')\n"
PROGRAMS = {
    "asks_for_a_number": f"{BEGIN}import rclpy\nspeed = float(input('speed? '))\n{REST}",
    "asks_for_two": f"{BEGIN}x, y = map(int, input().split(','))\n{REST}",
    "asks_for_two_by_turns": f"{BEGIN}x = float(input())\ny = float(input())\n{REST}",
    "asks_for_a_word": f"{BEGIN}assert input() == 'forward'\n{REST}",
    "reads_single_keys": f"{BEGIN}import tty\ntty.setcbreak(sys.stdin.fileno())\nsys.stdin.read(1)\n{REST}",
    "reads_what_is_there": f"{BEGIN}sys.stdin.readline()\n{REST}",
    "is_broken_behind_it": f"{BEGIN}input()\n{BROKEN}{REST}",
    "ends_at_a_key": f"{BEGIN}{REST.replace('rclpy.spin(node)', '')}while sys.stdin.read(1) != 'q':\n    publisher.publish(Twist())\n",
    "ends_sooner_or_later": f"{BEGIN}import random\nfor _ in range(random.randrange(1, 6)):\n    input()\n{BROKEN}{REST}",
    "ends_after_one": f"{BEGIN}{REST.replace('rclpy.spin(node)', '')}input()\n",
    "logs_behind_a_prompt": f"{BEGIN}{REST.replace('rclpy.spin(node)', '')}while rclpy.ok():\n    node.get_logger().info('heard ' + input('word? '))\n",
    "is_silent_behind_it": f"{BEGIN}input()\n{REST.replace('publisher.publish(Twist())', 'None')}",
}
ANSWERED = (
    "asks_for_a_number",
    "asks_for_two",
    "asks_for_two_by_turns",
    "asks_for_a_word",
    "reads_single_keys",
)


RUN_TOGETHER = pytest.mark.long(together=True)  # all programs are watched once, for minutes on a busy machine


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Run]:
    folder = tmp_path_factory.mktemp("programs")
    for name, text in PROGRAMS.items():
        (folder / f"{name}.py").write_text(text)
    programs = [
        Executable(name, "", "script", [sys.executable, f"{FILES}/{name}.py"], absent=[KEYBOARD])
        for name in PROGRAMS
    ]
    built = Build(False, "", [], [], programs, [], underlay(), 0.0)
    submission = Submission("files", None, [], None, [], [])
    with World(folder, shown=SHOWN) as world, Observer(world, rooms=3, seconds=math.inf) as observer:
        seen = watch(observer, submission, Files(compared=["forward", "q"]), built)
    return {run.programs[0]: run for run in seen if run.setting == "alone"}


@RUN_TOGETHER
@pytest.mark.parametrize("name", ANSWERED)
def test_what_comes_behind_an_answer_is_seen(runs: dict[str, Run], name: str) -> None:
    assert runs[name].quiet["/cmd_vel"].count > 2
    assert runs[name].typed


@RUN_TOGETHER
def test_what_goes_on_without_an_answer_needs_none(runs: dict[str, Run]) -> None:
    assert runs["reads_what_is_there"].quiet["/cmd_vel"].count > 2
    assert not runs["reads_what_is_there"].typed


@RUN_TOGETHER
def test_what_is_broken_behind_it_is_seen_to_be(runs: dict[str, Run]) -> None:
    assert "it never worked" in runs["is_broken_behind_it"].ended["is_broken_behind_it"]
    assert runs["is_silent_behind_it"].typed
    assert not runs["is_silent_behind_it"].ended
    assert not runs["is_silent_behind_it"].quiet


@RUN_TOGETHER
def test_what_is_logged_behind_a_prompt_is_one_line_and_not_two(runs: dict[str, Run]) -> None:
    log = [(level, text) for level, text in runs["logs_behind_a_prompt"].log if "heard" in text]
    assert {level for level, _ in log} == {"INFO"}


@RUN_TOGETHER
def test_what_an_answer_ends_is_given_another_one(runs: dict[str, Run]) -> None:
    """What ends behind whatever is typed, soon or late, has ended by itself."""
    assert not runs["ends_at_a_key"].ended
    assert runs["ends_at_a_key"].quiet["/cmd_vel"].count > 2
    assert len(runs["ends_after_one"].typed) == 1
    assert runs["ends_after_one"].ended
    assert "it never worked" in runs["ends_sooner_or_later"].ended["ends_sooner_or_later"]


def test_lines_are_typed_one_by_one_as_they_are_read() -> None:
    first = answers(["go"], ())
    keyboard = Keyboard(first)
    try:
        for number in range(1, 4):
            keyboard.type()
            assert select.select([keyboard.stdin], [], [], 60)[0]  # it comes by way of the kernel's workers
            keyboard.type()
            assert len(keyboard.typed) == number
            assert os.read(keyboard.stdin, 100).decode().rstrip("\n") == first[number - 1]
    finally:
        keyboard.close()
        keyboard.close()
    keyboard.type()
    assert len(keyboard.typed) == 3


@pytest.mark.parametrize(
    ("wanted", "runs"),
    [([], 1), (["1", "y"], 1), (["1", "1"], 2), (["y", "1"], 6), (["go"], 5), (["1", "1", "go"], 5)],
)
def test_a_line_that_ends_a_program_gives_way_to_another_one(wanted: list[str], runs: int) -> None:
    """Whatever it asks for, in whatever order, until it goes on."""
    search = Search(answers(["go"], ()))
    for _ in range(runs - 1):
        typed = search.keys
        wrong = next(n for n, line in enumerate(wanted) if line != typed[n])
        search.ended(typed[: wrong + 1])
    assert search.keys[: len(wanted)] == wanted


@pytest.mark.parametrize("counts", [[1], [3], [1, 4, 2]])
def test_a_program_that_ends_whatever_is_typed_is_given_up(counts: list[int]) -> None:
    """Always behind as many lines, or behind now more, now fewer."""
    search = Search(answers(["go"], ()))
    for number in range(MOST_RUNS):
        if search.keys:
            search.ended(search.keys[: counts[number % len(counts)]])
    assert not search.keys


READERS = {
    "input": "input()\n",
    "in a function": "def ask():\n    return float(input('raise the speed to? '))\nask()\n",
    "a name for it": "ask = input\nask()\n",
    "a password": "import getpass, warnings\nwarnings.simplefilter('ignore')\ngetpass.getpass()\n",
    "single keys": "import sys, termios\ntermios.tcgetattr(sys.stdin)\n",
    "a terminal": "import os\nos.get_terminal_size(0)\n",
    "passed on": "try:\n    input()\nexcept EOFError as error:\n    raise error\n",
    "said otherwise": "try:\n    input()\nexcept EOFError:\n    raise EOFError('no speed')\n",
}
RAISERS = {
    "raised": "raise EOFError\n",
    "raised with a text": "raise EOFError('the track is over')\n",
    "raised in its words": "raise EOFError('EOF when reading a line')\n",
    "raised on a condition": "import sys\nif len(sys.argv) < 9: raise EOFError\n",
    "raised below": "def step():\n    raise EOFError()\nstep()\n",
    "of a file": "import pickle\npickle.loads(b'')\n",
    "of an archive": "import gzip\ngzip.decompress(gzip.compress(b'a')[:-1])\n",
    "of a terminal": "import termios\nraise termios.error(25, 'Inappropriate ioctl for device')\n",
    "of a device": "raise OSError(25, 'Inappropriate ioctl for device')\n",
}


def said_by(tmp_path: Path, text: str) -> str:
    """Return what a program of a submission says last where nobody sits at a keyboard."""
    file = tmp_path / "drive.py"
    file.write_text(text)
    ended = subprocess.run(
        [sys.executable, str(file)],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        start_new_session=True,
    )
    assert ended.returncode == 1
    return ended.stderr.replace(str(tmp_path), FILES)


@pytest.mark.parametrize("name", READERS)
def test_who_reads_a_keyboard_ends_for_want_of_it(tmp_path: Path, name: str) -> None:
    said = said_by(tmp_path, READERS[name])
    assert finds_no_keyboard(said)
    assert is_for_want(said)
    assert name == "said otherwise" or "no keyboard" in last_word(said)


@pytest.mark.parametrize("name", RAISERS)
def test_who_raises_such_an_error_ends_by_itself(tmp_path: Path, name: str) -> None:
    said = said_by(tmp_path, RAISERS[name])
    assert not is_for_want(said)
    assert "no keyboard" not in last_word(said)
