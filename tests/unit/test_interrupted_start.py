"""Ctrl-C in the first moments of a program, when it has nothing to say yet, shows no traceback."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

BOOTSTRAP = Path(__file__).parents[2] / "tools" / "bootstrap.py"
PRESSED = "import os, signal; os.kill(os.getpid(), signal.SIGINT)"


@pytest.mark.parametrize(
    ("program", "imported"),
    [
        ([str(BOOTSTRAP), "student"], "argparse"),
        (["-c", "from ros2lab.cli import main; main()"], "typer"),
        (["-c", "from portable_ros2.command import main; main()"], "argparse"),
    ],
    ids=["installer", "ros2lab", "ros2"],
)
def test_while_modules_are_imported(program: list[str], imported: str, tmp_path: Path) -> None:
    (tmp_path / f"{imported}.py").write_text(PRESSED)
    environ = {**os.environ, "PYTHONPATH": str(tmp_path)}
    finished = subprocess.run(
        [sys.executable, *program], env=environ, capture_output=True, text=True, check=False
    )
    assert (finished.returncode, finished.stderr) == (-signal.SIGINT, "")


def test_while_typer_puts_the_verbs_together() -> None:
    pressed = f"import typer.main; typer.main.get_command = lambda _: exec({PRESSED!r})"
    program = f"from ros2lab.cli import main; {pressed}; main()"
    finished = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (finished.returncode, finished.stderr) == (130, "")
