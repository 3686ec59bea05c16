"""The grader as it is installed from its wheel, where the course's solution lies beside it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import ros2lab
from ros2lab import course

COMMAND = [sys.executable, "-c", "from ros2lab.cli import main; main()"]
TIMEOUT = 240  # s
NODES = ("status_publisher", "command_subscriber", "velocity_publisher")

# Runs the node of the same name out of the course's workspace, wherever that can be seen.
STUB = """
import importlib
import sys
from pathlib import Path


def main(args=None):
    mounts = [line.split()[1] for line in open("/proc/self/mounts")]
    for folder in [*sys.path, *mounts, *(Path(mount).parent for mount in mounts)]:
        for found in Path(folder or ".").glob("ros2lab/course/robot_project_ws/src/robot_controller"):
            sys.path.insert(0, str(found))
            for name in [name for name in sys.modules if name.startswith("robot_controller")]:
                del sys.modules[name]
            importlib.import_module("robot_controller.NAME").main(args)
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder from which `ros2lab` is imported, with files where the repository has links."""
    folder = tmp_path_factory.mktemp("installed")
    ignored = shutil.ignore_patterns("__pycache__", "build", "install", "log")
    shutil.copytree(Path(ros2lab.__file__).parent, folder / "ros2lab", ignore=ignored)
    assert (folder / "ros2lab/course/robot_project_ws/src/robot_controller/package.xml").is_file()
    return folder


def test_nodes_of_the_solution_that_was_installed_with_the_grader_get_nothing(
    installed: Path, tmp_path: Path
) -> None:
    workspace = course.copy_reference(tmp_path / "handed in")
    package = workspace / "src/robot_controller"
    shutil.rmtree(package / "test")
    for path in (package / "robot_controller").glob("*.py"):
        path.write_text(STUB.replace("NAME", path.stem) if path.stem in NODES else "")
    done = subprocess.run(
        [*COMMAND, "grade", str(workspace), "--json", "-"],
        env={**os.environ, "PYTHONPATH": str(installed)},
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    components = json.loads(done.stdout)["components"]
    assert {components[name]["points"] for name in NODES} == {0}
