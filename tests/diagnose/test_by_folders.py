"""Imports of the workspace's own modules with the folders above them: what is told is imported by Python."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text
from ros2lab.diagnose.look import Look

NAME = NAMES[0]
TOLD = "This import begins with folders above the package robot_controller"


def workspace(root: Path, line: str, used: str = "") -> Path:
    files = Files.right(NAME).put("PACKAGE/sums.py", "def count():\n    return 4\n")
    files.change("node", "import rclpy\n", f"import rclpy\n{line}\n{used}")
    return files.write(root)


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("from src.PK.PK.sums import count", "from PK.sums import count"),
        ("from my_ws.src.PK.PK.sums import count as c", "from PK.sums import count as c"),
        ("from PK.PK.sums import count", "from PK.sums import count"),
        ("from src.PK.sums import (\n    count,\n)", "from PK.sums import count"),
        ("from src.PK.PK import sums", "from PK import sums"),
        ("import src.PK.PK.sums as s", "import PK.sums as s"),
        ("import install.PK.PK.sums", "import PK.sums"),
    ],
)
@pytest.mark.parametrize("is_printed", [False, True])
def test_folders_above_a_package(tmp_path: Path, line: str, fix: str, is_printed: bool) -> None:
    line, fix = line.replace("PK", NAME.package), fix.replace("PK", NAME.package)
    root = workspace(tmp_path, line)
    top = re.split(r"[ .]", line)[1]
    file = f"install/{NAME.package}/lib/python3.11/site-packages/{NAME.package}/{NAME.module}.py"
    text = f'Traceback (most recent call last):\n  File "{root}/{file}", line 2, in <module>\n    {line.splitlines()[0]}\nModuleNotFoundError: No module named {top!r}\n'
    known = of_text(text, root) if is_printed else Look(root).findings
    (found,) = [each for each in known if TOLD in each.cause]
    assert found.place.endswith(f"{NAME.module}.py:2")
    assert found.fix == f"write `{fix}`, and build again"
    folder = root / "src" / NAME.package
    done = subprocess.run([sys.executable, "-c", fix], cwd=folder, capture_output=True, check=False)
    assert done.returncode == 0


def test_where_the_module_is_used_is_told_too(tmp_path: Path) -> None:
    written = f"src.{NAME.package}.{NAME.package}.sums"
    root = workspace(tmp_path, f"import {written}", f"print({written}.count())\n")
    (found,) = [each for each in Look(root).findings if TOLD in each.cause]
    assert f"and {NAME.package}.sums instead of {written} on line 3" in found.fix


@pytest.mark.parametrize(
    "line",
    [
        "from PK.sums import count",
        "import PK.sums",
        "from PK import sums",
        "from .sums import count",
        "from PK.src.sums import count",
        "try:\n    from src.PK.PK.sums import count\nexcept ImportError:\n    count = None",
        "from serial.tools.sums import count",
        "import os.path",
    ],
)
def test_imports_that_are_right_or_of_something_else(tmp_path: Path, line: str) -> None:
    root = workspace(tmp_path, line.replace("PK", NAME.package))
    (root / "src" / NAME.package / NAME.package / "src").mkdir()
    (root / "src" / NAME.package / NAME.package / "src" / "__init__.py").touch()
    (root / "src" / NAME.package / NAME.package / "src" / "sums.py").write_text(
        "def count():\n    return 4\n"
    )
    assert not [each for each in Look(root).findings if TOLD in each.cause]
