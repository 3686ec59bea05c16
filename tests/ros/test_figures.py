"""The figures of README are measured by one command, which works; that they are good is not tested."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


def figures(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(BENCHMARKS / "figures.py"), *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=200,
    )


@pytest.mark.thorough  # for who writes README
def test_a_figure_is_measured_and_written(tmp_path: Path) -> None:
    """A command in a real kernel changes the Twist at another process, and the time goes into the file."""
    file = tmp_path / "figures.json"
    finished = figures("command_to_twist", "--quick", "--json", str(file))
    assert finished.returncode == 0, finished.stderr
    (row,) = json.loads(file.read_text(encoding="utf-8"))["rows"]
    assert row["measured"]["count"] == row["peer"]["count"] == 20
    assert 0 < row["measured"]["value"] <= row["measured"]["p99"]
    assert row["ratio"] == row["measured"]["value"] / row["peer"]["value"]
    assert "bare rclpy hop" in finished.stdout


@pytest.mark.parametrize("arguments", [("no_such_figure",), ("--slow",)])
def test_what_is_not_known_is_refused(arguments: tuple[str, ...]) -> None:
    """A wrong name or option ends with a sentence and names what there is."""
    finished = figures(*arguments)
    assert finished.returncode == 2
    assert arguments[0] in finished.stderr
    assert "Traceback" not in finished.stderr


def test_help_names_every_figure() -> None:
    """Each function that measures is in the help, and each name in the help is one; `measure` goes by its module."""
    text = figures("--help").stdout
    functions = {
        f"{path.stem}.{name}".removesuffix(".measure")
        for path in BENCHMARKS.glob("*.py")
        for name in re.findall(r"^def ([a-z]\w+)\(\s*\w+: .*, \*, is_quick\b", path.read_text(), re.MULTILINE)
    }
    named = {line.split()[0] for line in text.partition("figures:\n")[2].splitlines()}
    assert named == functions
