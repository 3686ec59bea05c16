"""Warnings of real tools: passed on with their own hint, at the line that they are about."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text
from ros2lab.diagnose.finding import SAID

NAME = NAMES[1]


def printed(root: Path, name: str, code: str, *command: str) -> tuple[str, Path]:
    """Write a file of the package, and return what a command prints of it."""
    files = Files.right(NAME)
    files.put(name, code).write(root)
    file = root / files.path(name)
    done = subprocess.run(
        [sys.executable, *command, file],
        cwd=file.parents[1],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=120,
        check=False,
    )
    return done.stdout, file


def warned_by_pytest(root: Path, code: str) -> tuple[Finding, str, Path]:
    """Return what is said of the warnings of a test, with what pytest has printed."""
    text, file = printed(root, "test/test_it.py", code, "-m", "pytest", "-p", "no:cacheprovider")
    assert "Warning" in text, text
    return of_text(f"$ colcon test\n{text}", root)[0], text, file


RETURNS = """\
def both(a):
    return a * 2


def test_one():
    x = both(1)
    return x == 2


class TestMore:
    def test_two(self):
        return both(2) == 4
"""


def test_a_test_that_returns(tmp_path: Path) -> None:
    """All of them are told, and the function that is right to return is none of them."""
    finding, _, file = warned_by_pytest(tmp_path, RETURNS)
    assert finding.code == SAID
    assert "Did you mean to use `assert` instead of `return`?" in finding.cause
    assert finding.place == "src/my_bot/test/test_it.py:7"
    assert finding.fix == "write `assert x == 2`; and likewise on line 12"
    lines = RETURNS.splitlines()
    for number in (7, 12):
        lines[number - 1] = lines[number - 1].replace("return", "assert")
    text, _ = printed(tmp_path, "test/test_it.py", "\n".join(lines), "-m", "pytest", "-p", "no:cacheprovider")
    assert "Warning" not in text
    assert file.exists()


def test_a_mark_that_is_not_known(tmp_path: Path) -> None:
    finding, *_ = warned_by_pytest(
        tmp_path, "import pytest\n\n\n@pytest.mark.slwo\ndef test_one():\n    assert 1\n"
    )
    assert "Unknown pytest.mark.slwo - is this a typo?" in finding.cause
    assert finding.place == "src/my_bot/test/test_it.py:4"
    assert finding.fix == "you can register custom marks to avoid this warning"
    assert "https" not in finding.cause + finding.fix


def test_a_class_that_is_not_collected(tmp_path: Path) -> None:
    code = "class TestIt:\n    def __init__(self):\n        self.a = 1\n\n    def test_one(self):\n        assert 1\n"
    finding, *_ = warned_by_pytest(tmp_path, code)
    assert "because it has a __init__ constructor" in finding.cause
    assert finding.place == "src/my_bot/test/test_it.py:1"


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("if name is 'anna':", "if name == 'anna':"),
        ("if name is not 'anna':", "if name != 'anna':"),
    ],
)
def test_a_comparison_that_python_warns_of(tmp_path: Path, line: str, fix: str) -> None:
    text, _ = printed(tmp_path, "PACKAGE/named.py", f"name = input and 'a'\n{line}\n    print(name)\n")
    assert "SyntaxWarning" in text
    finding, *_ = of_text(text, tmp_path)
    assert finding.place == "src/my_bot/my_bot/named.py:2"
    assert "Python stops" not in finding.cause
    assert fix in finding.fix or "==" in finding.fix or "!=" in finding.fix


@pytest.mark.parametrize("kind", ["UserWarning", "FutureWarning"])
def test_what_a_library_asks_to_be_used(tmp_path: Path, kind: str) -> None:
    """Whichever library warns, and however it words that."""
    (tmp_path / "lib/site-packages").mkdir(parents=True)
    said = "go_to() is old. Please use drive_to instead of go_to, which takes a pose"
    (tmp_path / "lib/site-packages/robots.py").write_text(
        f"import warnings\n\n\ndef go_to():\n    warnings.warn({said!r}, {kind}, stacklevel=2)\n"
    )
    code = f"import sys\n\nsys.path.insert(0, {str(tmp_path / 'lib/site-packages')!r})\nimport robots\n\nrobots.go_to()\n"
    text, _ = printed(tmp_path, "PACKAGE/named.py", code)
    finding, *_ = of_text(text, tmp_path)
    assert finding.place == "src/my_bot/my_bot/named.py:6"
    assert "Please use drive_to instead of go_to" in finding.cause
    assert finding.fix == "write `robots.drive_to()`"
