"""The `ros2` command as a student types it: a process of its own."""

from __future__ import annotations

import os
import subprocess
import sysconfig
from collections.abc import Callable
from pathlib import Path

import pytest

COMMAND = str(Path(sysconfig.get_path("scripts"), "ros2"))
TIMEOUT = 120.0  # s

Ros2 = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def ros2(tmp_path: Path) -> Ros2:
    """Return a function that runs `ros2` with the given words, in the test's own folder."""

    def run(
        *words: str, cwd: Path = tmp_path, text: str = "", **variables: str
    ) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [COMMAND, *words],
            cwd=cwd,
            input=text,
            env={**os.environ, **variables},
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
            check=False,
        )

    return run
