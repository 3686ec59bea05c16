"""What the widgets leave in a notebook that a real kernel ran."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest

from ros2lab import environment
from ros2lab.widget_state import WIDGET_VIEW

ROOT = Path(__file__).parents[2]
CELLS = [
    "from geometry_msgs.msg import Twist\n"
    "from ros2lab import CommandPanel, LabSession, NodeLog, SideBySide, TwistPlot\n"
    "session = LabSession()",
    "panel = CommandPanel(session)\nplot = TwistPlot(session)\nSideBySide(panel, plot)",
    "TwistPlot(session, topic='/other')",
    "NodeLog(session)",
    # The redraw thread sends to the browser meanwhile.
    "for _ in range(20):\n"
    "    session.publish('/cmd_vel', Twist())\n"
    "    plot.topic_log.wait_for(plot.topic_log.count + 1)",
]


def run(arguments: list[str], folder: Path) -> None:
    environ = {**environment.lab_environment(), "JUPYTER_PATH": str(ROOT / "tests" / "notebooks" / "jupyter")}
    environ.pop("PYTEST_ADDOPTS", None)
    finished = subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env=environ,
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert finished.returncode == 0, finished.stdout + finished.stderr


def executed(cells: list[str], folder: Path) -> Path:
    """Write a notebook and have nbclient execute it."""
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    nbformat.write(notebook, folder / "new.ipynb")
    options = ["--execute", "--ExecutePreprocessor.kernel_name=ros2lab", "--output=executed.ipynb"]
    run(["-m", "nbconvert", "--to=notebook", *options, "new.ipynb"], folder)
    return folder / "executed.ipynb"


def outputs(path: Path) -> list[list[Any]]:
    return [cell.outputs for cell in nbformat.read(path, as_version=4).cells]


def test_a_session_that_ends_leaves_pictures_and_no_views(tmp_path: Path) -> None:
    """And what redraws in the background prints into no cell."""
    path = executed([*CELLS, "session.close()"], tmp_path)
    first, both, plot, log, drive, last = outputs(path)
    assert first == drive == last == []
    texts = []
    for (output,) in (both, plot, log):
        assert set(output.data) == {"text/plain", "image/png"}
        texts.append(output.data["text/plain"])
    assert texts == [
        "SideBySide(CommandPanel(/robot/command), TwistPlot(/cmd_vel))",
        "TwistPlot(/other)",
        "NodeLog()",
    ]
    assert "20 messages" in both[0].metadata["image/png"]["alt"]
    assert "no message yet" in plot[0].metadata["image/png"]["alt"]


@pytest.mark.thorough
def test_nbval_finds_the_same_a_second_time(tmp_path: Path) -> None:
    path = executed([*CELLS, "session.close()"], tmp_path)
    run(["-m", "pytest", "-p", "conftest", "--nbval", "-q", str(path)], ROOT)


@pytest.mark.thorough
def test_a_session_that_is_left_open_keeps_its_views(tmp_path: Path) -> None:
    """The kernel's exit changes nothing any more: nobody listens to it."""
    path = executed(CELLS[:2], tmp_path)
    assert set(outputs(path)[1][0].data) == {"text/plain", "image/png", WIDGET_VIEW}
