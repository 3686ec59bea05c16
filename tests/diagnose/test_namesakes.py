"""Modules of one name in several packages: whose Python imported is told, and how each package keeps its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import Files, Names

from ros2lab.diagnose import of_text

OTHERS = {"arm": "def grip(x):\n    return x\n", "cam": "def blur(x):\n    return x\n"}


def laid_out(root: Path, texts: dict[str, str], asking: str, file: str) -> str:
    """Write packages with a module each, installed as they are, and return what Python prints for a node of arm."""
    paths = []
    for package, text in texts.items():
        files = Files.right(Names(package))
        files.put("node", f"{asking if package == 'arm' else ''}\n")
        for base in (f"src/{package}", f"install/{package}/lib/python3.11/site-packages"):
            files.texts[f"{base}/{file}"] = text
            files.texts[f"{base}/{package}/status_publisher.py"] = files.texts[files.path("node")]
            files.texts[f"{base}/{package}/__init__.py"] = ""
        files.write(root)
        paths.insert(0, str(root / f"install/{package}/lib/python3.11/site-packages"))
    environ = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    command = [sys.executable, "-m", "arm.status_publisher"]
    done = subprocess.run(command, env=environ, cwd="/", capture_output=True, text=True, check=False)
    return f"$ ros2 run arm status_publisher\n{done.stderr}"


@pytest.mark.parametrize(
    ("asking", "file", "fix"),
    [
        ("from common import grip", "common/__init__.py", "`from arm.common import grip`"),
        ("from common import grip as take", "common.py", "`from arm.common import grip as take`"),
        ("import common\ncommon.grip(1)", "common/__init__.py", "`from arm import common`"),
    ],
)
def test_the_module_of_another_package_is_told(tmp_path: Path, asking: str, file: str, fix: str) -> None:
    (first, *_) = of_text(laid_out(tmp_path, OTHERS, asking, file), tmp_path)
    assert first.code == "name-shadowed"
    assert "Python finds that of cam first" in first.cause
    assert first.place == "src/arm/arm/status_publisher.py:1"
    assert fix in first.fix


@pytest.mark.parametrize(
    ("texts", "asking"),
    [
        ({"arm": OTHERS["arm"]}, "from common import grib"),  # a slip
        (OTHERS, "from common import drop"),  # in neither
    ],
)
def test_a_name_that_the_own_module_lacks_is_no_namesakes(
    tmp_path: Path, texts: dict[str, str], asking: str
) -> None:
    (first, *_) = of_text(laid_out(tmp_path, texts, asking, "common/__init__.py"), tmp_path)
    assert first.code != "name-shadowed"
