"""Calls that only make a coroutine or a generator, which nobody runs."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

NAME = NAMES[1]
ASYNC = "import asyncio\nimport rclpy\n"
LATER = "async def later():\n    await asyncio.sleep(1)\n\n\n"
READY = "async def ready():\n    print('ready')\n\n\n"
COUNTS = "def counts():\n    yield 1\n\n\n"
BODY = "def main(args=None):\n"


def told(root: Path, *changes: tuple[str, str]) -> list[tuple[str, str]]:
    files = Files.right(NAME)
    for old, new in changes:
        files.change("node", old, new)
    codes = ("no-effect", "entry-point-function")
    return [(one.code, one.fix) for one in of_workspace(files.write(root)) if one.code in codes]


@pytest.mark.parametrize(
    ("main", "runs"),
    [
        ("async def main(args=None):\n    await asyncio.sleep(1)\n", "def run_main(): asyncio.run(main())"),
        ("async def main():\n", "def run_main(): asyncio.run(main())"),
        ("def main(args=None):\n    yield\n", "def run_main(): list(main())"),
        ("def again(function):\n    return function\n\n\n@again\nasync def main(args=None):\n", ""),
        ("async def other():\n    pass\n\n\ndef main(args=None):\n    asyncio.run(other())\n", ""),
    ],
)
def test_an_entry_point_whose_call_runs_nothing(tmp_path: Path, main: str, runs: str) -> None:
    found = told(tmp_path, ("import rclpy\n", ASYNC), (BODY, main))
    assert [runs in fix for code, fix in found if code == "entry-point-function"] == [True] * bool(runs)


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("later()", "or asyncio.run(later())"),
        ("ready()", "write def instead of async def for ready"),
        ("counts()", "write `for _ in counts(): pass`"),
        ("asyncio.run(later())", ""),
        ("list(counts())", ""),
        ("task = later()\n    asyncio.run(task)", ""),
    ],
)
def test_a_statement_whose_call_runs_nothing(tmp_path: Path, line: str, fix: str) -> None:
    above = LATER + READY + COUNTS + BODY
    found = told(tmp_path, ("import rclpy\n", ASYNC), (BODY, f"{above}    {line}\n"))
    assert [(code, fix in said) for code, said in found] == ([("no-effect", True)] if fix else [])


def test_a_method_that_a_callback_only_names_as_a_coroutine(tmp_path: Path) -> None:
    asked = (
        "    async def step(self):\n        self.count += 1\n\n    def CALLBACK(self):\n        self.step()\n"
    )
    ((code, fix),) = told(tmp_path, ("    def CALLBACK(self):\n", asked))
    assert (code, fix) == ("no-effect", "write def instead of async def for step")
