"""What a notebook shows under a cell that has failed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import RichOutput, capture_output

from ros2lab.diagnose import Finding
from ros2lab.diagnose.explaining import notebook
from ros2lab.diagnose.explaining.steps import go_step_by_step
from ros2lab.terminal import magic

NODE = """\
from rclpy.node import Node

class N(Node):
    def __init__(self):
        super().__init__('n')
        self.publishers = []

    def tick(self):
        pass
"""


@pytest.fixture
def shell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[InteractiveShell]:
    """Return a kernel's shell that explains."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    shell = InteractiveShell.instance(colors="nocolor")
    shell.history_manager.enabled = False
    notebook.load_ipython_extension(shell)
    notebook.load_ipython_extension(shell)
    magic.load_ipython_extension(shell)
    yield shell
    magic.close_all()
    notebook.unload_ipython_extension(shell)
    shell.history_manager.end_session()
    shell.history_manager.save_thread and shell.history_manager.save_thread.stop()
    InteractiveShell.clear_instance()


def shown(shell: InteractiveShell, cell: str) -> list[RichOutput]:
    """Run a cell, and return what was shown below its error."""
    with capture_output() as captured:
        shell.run_cell(cell, store_history=False)
    outputs: list[RichOutput] = captured.outputs
    return outputs


def test_an_exception_in_a_cell_is_explained_once(shell: InteractiveShell) -> None:
    start = "from rclpy.signals import SignalHandlerOptions\nimport rclpy\n"
    shown(shell, f"{start}rclpy.init(signal_handler_options=SignalHandlerOptions.NO)")
    try:
        (output,) = shown(shell, f"{NODE}\nN()\n")
    finally:
        shown(shell, "rclpy.try_shutdown()")
    assert "publishers is already a property of every node" in output.data["text/plain"]
    assert "line 6" in output.data["text/plain"]
    assert "<b>Cause:</b>" in output.data["text/html"]


def test_a_syntax_error_is_explained(shell: InteractiveShell) -> None:
    (output,) = shown(shell, "def f():\nreturn 1\n")
    assert "indent" in output.data["text/plain"]


@pytest.mark.parametrize("cell", ["def f():\nreturn 1\n", f"{NODE}\nN(\n"])
def test_a_cell_is_not_called_by_the_name_of_a_file(shell: InteractiveShell, cell: str) -> None:
    (output,) = shown(shell, cell)
    text = output.data["text/plain"]
    assert "Cell In[" in text
    assert ", line " in text
    assert "ipython" not in text


def test_code_is_no_formula(shell: InteractiveShell) -> None:
    """JupyterLab sets what stands between two dollars."""
    output = notebook.Explanation(Finding("x", "$base is not $HOME", "", ""))
    assert 'class="mathjax_ignore tex2jax_ignore"' in output._repr_html_()


def test_a_cell_that_succeeds_shows_nothing(shell: InteractiveShell) -> None:
    assert shown(shell, "a = 1") == []


@pytest.mark.parametrize(
    "cell",
    [
        "1 / 0",
        "raise ValueError('x')",
        "raise KeyboardInterrupt",
        "from ros2lab.checks import CheckError\nraise CheckError('a', 'b', 'c')",
    ],
)
def test_it_is_silent_where_it_has_nothing_to_add(shell: InteractiveShell, cell: str) -> None:
    assert shown(shell, cell) == []


def test_a_command_that_fails_in_a_terminal_is_explained(shell: InteractiveShell) -> None:
    """From what this cell has printed, and not from what an earlier one has."""
    (output,) = shown(shell, "%%terminal\necho \"error: can't copy 'resource/pk': doesn't exist\"; false")
    assert "touch resource/pk" in output.data["text/plain"]
    assert shown(shell, "%%terminal\nfalse") == []
    own = "ros2lab() { echo \"ModuleNotFoundError: No module named 'rospy'\"; false; }\nros2lab diagnose"
    assert shown(shell, f"%%terminal\n{own}") == []  # it has said what is wrong
    (output,) = shown(shell, "%%terminal other\necho \"ModuleNotFoundError: No module named 'rospy'\"; false")
    assert "ROS 1" in output.data["text/plain"]


def test_what_it_shows_is_escaped() -> None:
    explanation = notebook.Explanation(Finding("unknown", "<script>&", "a<b.py:1", "write <b>"))
    assert "<script>" not in explanation._repr_html_()
    assert "&lt;script&gt;&amp;" in explanation._repr_html_()
    assert repr(explanation) == "Cause: <script>&\nPlace: a<b.py:1\nFix: write <b>"


def test_it_never_raises(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("ours")

    monkeypatch.setattr(notebook, "find_cause", fail)

    class Result:
        error_in_exec = ValueError("the student's")
        error_before_exec = None

    notebook.explain_cell(Result())


def test_what_an_earlier_cell_has_made_is_no_fault(shell: InteractiveShell) -> None:
    shown(shell, "import math")
    assert shown(shell, "int(math.pi, math.e, math.tau)") == []


def test_a_missing_import_is_named(shell: InteractiveShell) -> None:
    (output,) = shown(shell, "twist = Twist()")
    assert "from geometry_msgs.msg import Twist" in output.data["text/plain"]


def test_in_a_workspace_of_exercises_the_cause_is_shown_and_the_rest_is_folded(
    shell: InteractiveShell, tmp_path: Path
) -> None:
    go_step_by_step(tmp_path / "ward_ws")
    failing = "echo \"error: can't copy 'resource/pk': doesn't exist\"; false"
    (output,) = shown(shell, f"%%terminal\ncd ~/ward_ws\n{failing}")
    assert "touch resource/pk" not in output.data["text/plain"]
    assert "<details><summary><b>Fix</b></summary>" in output.data["text/html"]
    (output,) = shown(shell, f"%%terminal\ncd ~\n{failing}")
    assert "<details>" not in output.data["text/html"]
