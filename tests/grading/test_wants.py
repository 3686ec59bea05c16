"""What the machine lacks is known by who raised an error, not by what a program says."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

import evidences
import pytest

from ros2lab.grading.evidence import Evidence, Executable, Files, Place, WrittenEnd
from ros2lab.grading.judging.player import is_for_want, lacked
from ros2lab.grading.rubric import load
from ros2lab.grading.sandbox.keeper import LIMITS, is_limit
from ros2lab.grading.sandbox.worlds import FILES
from ros2lab.grading.verdict import verdict
from ros2lab.grading.watching.job import LINE, _last_lines

OPENS = "open('/dev/motors0')\n"
# What code does, and which resource it lacks.
LACKING = {
    "opens": (OPENS, "a device"),
    "opens another way": ("import os\nos.open('/dev/motors0', os.O_RDWR)\n", "a device"),
    "raises again": (f"try:\n    {OPENS}except OSError:\n    raise\n", "a device"),
    "passes on": (f"try:\n    {OPENS}except OSError as error:\n    raise error\n", "a device"),
    "says otherwise": (
        f"try:\n    {OPENS}except OSError as error:\n    raise RuntimeError('no motors') from error\n",
        "a device",
    ),
    "says otherwise twice": (
        "def opens():\n"
        f"    try:\n        {OPENS}    except OSError as error:\n        raise RuntimeError('no motors') from error\n"
        "def start():\n"
        "    try:\n        opens()\n    except RuntimeError:\n        raise ValueError('no robot')\n"
        "def main():\n    def deep():\n        def deeper():\n            start()\n        deeper()\n    deep()\n"
        "main()\n",
        "a device",
    ),
    "prints its traceback": (
        f"import sys, traceback\ntry:\n    {OPENS}except OSError:\n    traceback.print_exc()\n    sys.exit(1)\n",
        "a device",
    ),
    "connects": (
        "import socket\nsocket.create_connection(('127.0.0.1', 9), timeout=5)\n",
        "a network",
    ),
    "a library raises": ("import library\nlibrary.connect()\n", "a device"),
}
# What a program says by itself.
SAYING = {
    "raises": "raise RuntimeError('motors: OSError: /dev/motors0')\n",
    "raises its error": "raise OSError(2, 'No such file or directory', '/dev/motors0')\n",
    "raises below": "def connect():\n    raise ConnectionError('Connection refused')\nconnect()\n",
    "raises on a value": "try:\n    int('x')\nexcept ValueError as error:\n    raise OSError('/dev/motors0') from error\n",
    "its own error": "class NetError(Exception):\n    pass\nraise NetError('Network is unreachable')\n",
    "a class of the name": "class NotInstalledHere(Exception):\n    pass\nraise NotInstalledHere('motors')\n",
    "a text of the name": "raise RuntimeError('NotInstalledHere')\n",
    "a value": "int('Connection refused')\n",
    "a key": "{}['/dev/motors0']\n",
    "an assertion": "assert False, '/dev/motors0'\n",
    "lines of its own": "raise RuntimeError('x\\nOSError: /dev/motors0')\n",
}


MUTE = Executable("drive", "", "script", [], modules=["drive"])  # a program that catches no error


def said_by(folder: Path, text: str) -> str:
    """Return what is kept of the output of a program of a submission."""
    (folder / "files").mkdir()
    file = folder / "files/drive.py"
    file.write_text(text)
    (folder / "library.py").write_text(
        "class PortError(IOError):\n    pass\ndef connect():\n    raise PortError('could not open /dev/motors0')\n"
    )
    ended = subprocess.run(
        [sys.executable, str(file)],
        env={"PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert ended.returncode == 1
    return _last_lines(ended.stderr.replace(f"{folder}/files", FILES))


@pytest.mark.parametrize("name", LACKING)
def test_what_a_machine_lacks_is_known_over_all_causes(tmp_path: Path, name: str) -> None:
    text, resource = LACKING[name]
    said = said_by(tmp_path, text)
    assert lacked(said, MUTE, Files()) == [resource]
    assert is_for_want(said)


@pytest.mark.parametrize("name", SAYING)
def test_what_a_program_says_is_nothing_that_the_machine_lacks(tmp_path: Path, name: str) -> None:
    said = said_by(tmp_path, SAYING[name])
    assert not is_for_want(said)
    assert not lacked(said)


def test_a_line_that_begins_with_a_function_of_python_is_no_error_of_it() -> None:
    assert lacked("open: could not open display") == ["a display"]


def test_the_error_of_a_stand_in_may_be_raised() -> None:
    """Its class is that of a module which is not here, and its only word its name."""
    frame = f'Traceback (most recent call last):\n  File "{FILES}/drive.py", line 3, in main\n'
    raised = f"{frame}    raise board.NoBoard('no board')\nboard.NotInstalledHere: NotInstalledHere\n"
    derived = f"{frame}    raise MyError('no board')\ndrive.MyError: NotInstalledHere\n"
    used = f"{frame}    Call()\nAttributeError: type object 'NotInstalledHereType' has no attribute '_TYPE_SUPPORT'\n"
    assert is_for_want(used)
    assert is_for_want(raised)
    assert is_for_want(derived)


@pytest.mark.parametrize(
    ("handlers", "is_believed"),
    [
        ({}, False),
        ({"of an end": [Place("robot_controller/drive.py", 9)]}, False),
        ({"by name": [Place("robot_controller/other.py", 9)]}, False),
        ({"by name": [Place("robot_controller/drive.py", 9)]}, True),
        ({"wholesale": [Place("robot_controller/motors.py", 9)]}, True),
    ],
)
@pytest.mark.parametrize(
    "said",
    ["OSError: no answer from /dev/motors0", "ConnectionRefusedError: [Errno 111] Connection refused"],
)
def test_what_is_printed_counts_where_an_error_may_have_been_caught(
    handlers: dict[str, list[Place]], is_believed: bool, said: str
) -> None:
    """Without a traceback, only a handler in the program's own modules can have printed it."""
    e = evidences.files(handlers=handlers)(evidences.right())
    assert e.build
    program = replace(
        e.build.executables[0], name="drive", target="p.drive:main", modules=["drive", "motors"]
    )
    assert bool(lacked(said, program, e.files)) is is_believed
    assert lacked(said, replace(program, modules=[]), e.files)  # it may come from anywhere


def test_the_causes_of_an_error_are_kept_with_its_end() -> None:
    cause = ["Traceback (most recent call last):", '  File "a.py", line 1, in b', "    f()", "OSError: x", ""]
    link = ["The above exception was the direct cause of the following exception:", ""]
    frames = [line for n in range(20) for line in (f'  File "a.py", line {n}, in c', "    g()")]
    lines = [*["a line"] * 50, *cause, *link, cause[0], *frames, "RuntimeError: y"]
    kept = _last_lines("\n".join(lines)).splitlines()
    assert kept == [*lines[49:56], *lines[-10:]]
    assert _last_lines("\n".join([*cause, *link, "RuntimeError: y"])).splitlines() == [
        *cause,
        *link,
        "RuntimeError: y",
    ]
    assert _last_lines("x\n" * 99 + "y" * (LINE + 1)) == "\n".join(["x"] * 9 + ["y" * LINE])


@pytest.mark.parametrize("limit", LIMITS)
def test_no_program_says_that_a_limit_ended_it(limit: str) -> None:
    said = LIMITS[limit].format(5)
    assert is_limit(said)
    assert not is_limit(_last_lines(said))
    assert said in _last_lines(said)


REFUSED = (
    f'Traceback (most recent call last):\n  File "{FILES}/n.py", line 3, in on_command\n    sock.connect(a)\n'
    "ConnectionRefusedError: [Errno 111] Connection refused"
)


def _robust(e: Evidence) -> float:
    grade = verdict(e, load())
    return next(one.points for one in grade.criteria if one.id == f"{evidences.COMMAND}.robustness")


def _at(word: str, said: str) -> Evidence:
    ends = [WrittenEnd("/robot/command", evidences.STRING, False, [], evidences.COMMAND, ["reads"])]
    return evidences.ended(evidences.COMMAND, said, word)(evidences.files(ends=ends)(evidences.right()))


def _words(is_known: bool) -> Collection[str]:
    run = evidences.command_run()
    part = load().assignment.commanded
    assert part
    texts = [command.text for command in run.commands]
    return [text for text in texts if (text in part.commands) is is_known and text]


def test_an_unknown_word_is_no_reason_to_ask_a_machine_for_more() -> None:
    """What known words did not need, the node can do without."""
    known, unknown = next(iter(_words(is_known=True))), next(iter(_words(is_known=False)))
    assert _robust(_at(unknown, REFUSED)) == 0
    assert _robust(_at(known, REFUSED)) > 0
