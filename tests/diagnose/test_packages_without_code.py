"""Packages that setup.py does not list: only those with something to install are missed."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose.look import Look

PACKAGE = NAMES[0].package


def codes_with(tmp_path: Path, init: str | None, *, keep: bool = False) -> set[str]:
    """Return what is found in a package with `packages=[]`: launch files and an __init__.py, or its nodes too."""
    files = Files.right(NAMES[0])
    files.change("setup.py", "find_packages(exclude=['test'])", "[]")
    root = files.write(tmp_path)
    home = root / "src" / PACKAGE / PACKAGE
    for path in () if keep else home.glob("*.py"):
        path.unlink()
    if init is not None:
        (home / "__init__.py").write_text(init)
    if not keep:
        (home.parent / "launch").mkdir(exist_ok=True)
        setup = home.parent / "setup.py"
        before, _, rest = setup.read_text().partition("'console_scripts': [")
        setup.write_text(f"{before}'console_scripts': [{rest[rest.index(']') :]}")
    return {finding.code for finding in Look(root).findings}


@pytest.mark.parametrize("init", [None, "", "# launch files only\n", '"""Launch files of the robot."""\n'])
def test_nothing_is_missed_of_a_package_without_a_module(tmp_path: Path, init: str | None) -> None:
    assert "package-not-listed" not in codes_with(tmp_path, init)


@pytest.mark.parametrize(
    "init", ["SPEED = 0.5\n", "from math import pi\n", "def half(x):\n    return x / 2\n"]
)
def test_an_init_file_with_code_is_missed(tmp_path: Path, init: str) -> None:
    assert "package-not-listed" in codes_with(tmp_path, init)


def test_nodes_are_missed(tmp_path: Path) -> None:
    assert "package-not-listed" in codes_with(tmp_path, None, keep=True)
