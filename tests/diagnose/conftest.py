"""Where the modules of this folder are found, and how many cases of a test `make test` runs."""

from __future__ import annotations

import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from ros2lab.diagnose.launching import launch_child
from warm import WarmCommand

HERE = Path(__file__).parent
MOST = 3  # of one test: each case is a question about a whole workspace, and all are of one kind

sys.path.insert(0, str(HERE))


@pytest.fixture(scope="session", autouse=True)
def _launch_is_warm() -> Iterator[None]:
    """Fork the process that loads launch files from one that has imported launch: half of the tests ask it."""
    module = launch_child.__name__
    command = WarmCommand([sys.executable, "-m", module], f"{module}:main", "launch_ros.actions")
    start = subprocess.run

    def run(words: Sequence[str], **given: Any) -> subprocess.CompletedProcess[Any]:
        if [*words[1:3]] != ["-m", module]:
            return start(words, **given)
        done = command.run(
            *words[3:], cwd=given["cwd"], environ=given["env"], text="", timeout=given["timeout"]
        )
        done.check_returncode()
        given["stdout"].write(done.stdout.encode())
        return done

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(subprocess, "run", run)
        yield
    command.close()


def pytest_collection_modifyitems(items: Sequence[pytest.Item]) -> None:
    """Mark the cases of a test as thorough but for some, which are taken at equal distances."""
    cases: dict[tuple[Path, str], list[pytest.Item]] = defaultdict(list)
    for item in items:
        if item.path.is_relative_to(HERE) and not item.get_closest_marker("thorough"):
            cases[item.path, item.nodeid.partition("[")[0]].append(item)
    for alike in cases.values():
        kept = {number * len(alike) // MOST for number in range(MOST)}
        for number, item in enumerate(alike):
            if len(alike) > MOST and number not in kept:
                item.add_marker(pytest.mark.thorough)
