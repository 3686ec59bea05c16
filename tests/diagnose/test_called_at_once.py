"""Calls that stand where a function is wanted, whatever takes it."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

NAME = NAMES[1]
IMPORTS = """\
import asyncio
import atexit
import signal
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from functools import partial
import rclpy
import rclpy.action
import rclpy.node
from rclpy.executors import SingleThreadedExecutor


def goodbye():
    print('bye')


def maker():
    return goodbye


async def later():
    goodbye()


class Asks(rclpy.node.Node):
    def done(self, what: str, future: rclpy.Future) -> None:
        print(what, future)

    def ask(self, future: rclpy.Future):
        LINE

    async def walk(self):
        print('step')

    def end(self) -> None:
        print('end')


executor = SingleThreadedExecutor()
"""


def told(line: str, root: Path) -> list[str]:
    files = Files.right(NAME).change("node", "import rclpy\n", f"{IMPORTS.replace('LINE', line)}\n")
    return [one.fix for one in of_workspace(files.write(root)) if one.code == "callback-called"]


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("threading.Thread(target=executor.spin()).start()", "write `target=executor.spin`"),
        ("threading.Thread(target=rclpy.spin(None))", "write `target=lambda: rclpy.spin(None)`"),
        ("threading.Timer(2.0, goodbye())", "write `goodbye`"),
        ("signal.signal(signal.SIGINT, goodbye())", "write `lambda value, other: goodbye()`"),
        ("atexit.register(goodbye())", "write `goodbye`"),
        ("ThreadPoolExecutor().submit(goodbye())", "write `goodbye`"),
        (
            "future.add_done_callback(self.done('stop', future))",
            "write `lambda future: self.done('stop', future)`",
        ),
        (
            "future.add_done_callback(self.done('stop'))",
            "write `lambda future: self.done('stop', future)`",
        ),
        ("future.add_done_callback(self.end())", "write `lambda value: self.end()`"),
        (
            "self.add_on_set_parameters_callback(self.end())",
            "write `lambda value: self.end()`",
        ),
        ("self.context.on_shutdown(self.end())", "write `self.end`"),
        ("executor.create_task(self.end())", "write `self.end`"),
        ("future.add_done_callback(self.walk())", "write `lambda value: self.walk()`"),
    ],
)
def test_what_is_called_too_early_is_told(tmp_path: Path, line: str, fix: str) -> None:
    assert told(line, tmp_path) == [fix]


@pytest.mark.parametrize(
    "line",
    [
        "threading.Thread(target=goodbye)",
        "threading.Thread(target=maker())",
        "future.add_done_callback(partial(self.done, 'stop'))",
        "future.add_done_callback(partial(self.done, what='stop'))",
        "future.add_done_callback(partial(goodbye))",
        "atexit.register(partial(self.end))",
        "threading.Thread(target=lambda: rclpy.spin(None))",
        "print(goodbye())",
        "self.executor.create_task(self.walk())",
        "executor.create_task(later())",
        "executor.create_task(callback=self.walk())",
        "asyncio.run(self.walk())",
        "asyncio.gather(self.walk(), later())",
        "sys.exit(goodbye())",
        "sorted([1, 2], key=abs)",
        "[goodbye(), goodbye()].count(goodbye())",
    ],
)
def test_what_is_meant_so_is_not(tmp_path: Path, line: str) -> None:
    assert told(line, tmp_path) == []
