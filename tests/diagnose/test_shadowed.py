"""A file of the student hides a module of Python or of a library: what Python then says, and what is told of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

INNER = "src/my_bot/my_bot"
LINE = "class WaitingLine:\n    people = []\n"
# What asks, the file that hides what it asks for, and the file's text.
HIDDEN = [
    ("import queue\nqueue.SimpleQueue()", "queue.py", LINE),
    ("from queue import Queue\nQueue()", "queue.py", LINE),
    ("import concurrent.futures\nconcurrent.futures.ThreadPoolExecutor(2)", "queue.py", LINE),
    ("import logging.handlers", "logging.py", "LEVEL = 3\n"),
    ("import statistics\nstatistics.mean([1, 2])", "statistics.py", "def total(a):\n    return sum(a)\n"),
    ("import json\njson.dumps({})", "json/__init__.py", ""),
    ("import rclpy.node", "rclpy.py", "SPEED = 1\n"),
    ("from launch import LaunchDescription", "launch.py", "def go():\n    pass\n"),
    ("import colorsys\ncolorsys.hls_to_rgb(0, 0, 0)", "colorsys.py", "RED = 'red'\n"),
]
RIGHT_NAMES = {LINE: "waiting_line.py"}


def printed(script: Path) -> str:
    """Return what Python says of a script."""
    command = [sys.executable, str(script)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return f"$ python3 {script}\n{done.stderr}"


@pytest.mark.parametrize(("asking", "hiding", "text"), HIDDEN)
def test_the_file_that_hides_is_told_and_renaming_it_is_enough(
    tmp_path: Path, asking: str, hiding: str, text: str
) -> None:
    root = Files.right(NAMES[1]).write(tmp_path)
    script, file = root / INNER / "asks.py", root / INNER / hiding
    script.write_text(f"{asking}\n")
    file.parent.mkdir(exist_ok=True)
    file.write_text(text)
    first = of_text(printed(script), root)[0]
    old = hiding.partition("/")[0]
    assert (first.code, first.place) == ("name-shadowed", f"{INNER}/{old}")
    new = first.fix.removeprefix(f"rename {old} to ").split(",")[0].split(";")[0]
    assert new == RIGHT_NAMES.get(text, f"own_{old}")
    (root / INNER / old).rename(root / INNER / new)
    assert "Error" not in printed(script)


def test_a_script_that_hides_what_it_imports_itself_is_told(tmp_path: Path) -> None:
    script = tmp_path / "colorsys.py"
    script.write_text("import colorsys\nprint(colorsys.hls_to_rgb(0, 0, 0))\n")
    first = of_text(printed(script))[0]
    assert (first.code, first.fix) == ("name-shadowed", "rename colorsys.py to own_colorsys.py")


def test_the_imports_of_the_file_are_named(tmp_path: Path) -> None:
    """What imports the file by its old name fails once that has another."""
    root = Files.right(NAMES[1]).write(tmp_path)
    (root / INNER / "asks.py").write_text(
        "from my_bot.queue import WaitingLine\nimport queue\nqueue.Empty()\n"
    )
    (root / INNER / "queue.py").write_text(LINE)
    text = f"""\
Traceback (most recent call last):
  File "{root / INNER / "asks.py"}", line 3, in <module>
    queue.Empty()
    ^^^^^^^^^^^
AttributeError: module 'queue' has no attribute 'Empty'
"""
    fix = of_text(text, root)[0].fix
    assert f"write my_bot.waiting_line instead of my_bot.queue in {INNER}/asks.py:1, then build again" in fix


def test_a_script_that_hides_its_own_package_is_told(tmp_path: Path) -> None:
    """Started with python3, `my_bot/my_bot.py` is what `import my_bot` finds."""
    root = Files.right(NAMES[1]).write(tmp_path)
    script = root / INNER / "my_bot.py"
    script.write_text("from my_bot.talker import main\n\nmain()\n")
    first = of_text(printed(script), root)[0]
    assert (first.code, first.place) == ("name-shadowed", f"{INNER}/my_bot.py")
    assert first.cause.endswith("so the package my_bot is hidden.")
    assert first.fix == "rename my_bot.py to own_my_bot.py"


def test_a_file_that_cannot_be_seen_is_asked_for(tmp_path: Path) -> None:
    """The real module has the name, so that the name is right."""
    root = Files.right(NAMES[1]).write(tmp_path)
    text = f"""\
Traceback (most recent call last):
  File "{root / INNER / "talker.py"}", line 3, in <module>
    random.uniform(0, 1)
    ^^^^^^^^^^^^^^
AttributeError: module 'random' has no attribute 'uniform'
"""
    first = of_text(text, root)[0]
    assert first.code == "name-shadowed"
    assert "Python's own random has uniform" in first.cause


@pytest.mark.parametrize(
    ("asking", "fix"),
    [
        ("import random\nrandom.unifrom(0, 1)", "write uniform instead of unifrom"),
        ("import random\nrandom.choise([1])", "write choice instead of choise"),
        ("import xml\nxml.etree.ElementTree", "write `import xml.etree.ElementTree` below line 1"),
    ],
)
def test_a_name_that_the_module_lacks_is_no_hidden_module(tmp_path: Path, asking: str, fix: str) -> None:
    root = Files.right(NAMES[1]).write(tmp_path)
    script = root / INNER / "asks.py"
    script.write_text(f"{asking}\n")
    assert of_text(printed(script), root)[0].fix == fix


def test_no_private_name_is_offered(tmp_path: Path) -> None:
    root = Files.right(NAMES[1]).write(tmp_path)
    script = root / INNER / "asks.py"
    script.write_text("import queue\nqueue.PySimpleQueue()\n")
    assert "_PySimpleQueue" not in of_text(printed(script), root)[0].fix


def test_nothing_is_written_for_a_name_that_the_line_does_not_have(tmp_path: Path) -> None:
    root = Files.right(NAMES[1]).write(tmp_path)
    text = f"""\
Traceback (most recent call last):
  File "{root / INNER / "talker.py"}", line 3, in <module>
    import concurrent.futures
  File "/usr/lib/python3.12/concurrent/futures/thread.py", line 150, in __init__
    self._work_queue = queue.SimplerQueue()
                       ^^^^^^^^^^^^^^^^^^
AttributeError: module 'queue' has no attribute 'SimplerQueue'
"""
    assert "write" not in of_text(text, root)[0].fix
