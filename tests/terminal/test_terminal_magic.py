"""`%%terminal` in a notebook."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from IPython.core.error import UsageError
from IPython.core.interactiveshell import InteractiveShell
from traitlets.config import Config

from ros2lab.terminal import TerminalError, load_ipython_extension, magic

Cell = Callable[..., str]


@pytest.fixture
def cell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Iterator[Cell]:
    """Return a function that runs a cell, first its options and then its lines, and returns what it shows."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    # Without a history, which is written by a thread.
    shell = InteractiveShell.instance(config=Config({"HistoryManager": {"enabled": False}}))
    load_ipython_extension(shell)

    def run(options: str, *lines: str) -> str:
        shell.run_cell_magic("terminal", options, "\n".join(lines) + "\n")
        shown = capsys.readouterr().out
        for colour in ("\x1b[1;32m", "\x1b[1;34m", "\x1b[0m"):
            shown = shown.replace(colour, "")
        return shown

    yield run
    magic.close_all()
    InteractiveShell.clear_instance()


def test_a_terminal_is_known_by_its_name(cell: Cell) -> None:
    cell("", "X=1")
    cell("other", "X=2")
    assert cell("", "echo $X") == "1:~$ echo $X\n1\n"
    assert cell("other", "echo $X") == "other:~$ echo $X\n2\n"


def test_an_error_marks_the_cell_unless_it_is_expected(cell: Cell) -> None:
    with pytest.raises(TerminalError, match="`false` failed with exit code 1"):
        cell("", "false")
    assert "yes" in cell("--expect-error", "ls /nowhere", "echo yes")
    with pytest.raises(TerminalError, match="should have failed"):
        cell("--expect-error", "true")
    assert "Write here" in cell("--expect-error", "# Write here.")  # nothing was tried yet


def test_a_cell_may_have_its_own_time_limit(cell: Cell) -> None:
    with pytest.raises(TerminalError, match="did not end in time"):
        cell("--timeout 0.3", "sleep 60")


def test_a_node_goes_on_in_the_background_and_the_cell_run_again_replaces_it(cell: Cell) -> None:
    for _ in range(2):
        assert cell("b --background", "sleep 60") == "b:~$ sleep 60\n"
        assert magic.terminal("b").is_busy
    assert len(magic._terminals) == 1
    magic.terminal("b").interrupt()
    assert cell("b", "echo ready").endswith("ready\n")


def test_a_comment_after_a_command_that_failed_does_not_fail(cell: Cell) -> None:
    cell("--expect-error", "false")
    assert cell("", "# Write here.", "echo yes").endswith("yes\n")


def test_what_goes_on_in_the_background_is_no_comment(cell: Cell) -> None:
    assert "# the end" not in cell("b --background", "# begin", "sleep 60", "# the end")
    assert magic.terminal("b").is_busy
    assert cell("c --background", "# Write here.") == ""


def test_a_dead_shell_is_replaced_with_a_sentence(cell: Cell) -> None:
    cell("", "X=1", "exit")
    shown = cell("", "echo [$X]")
    assert "had ended. This is a new one: nothing is sourced in it." in shown
    assert shown.endswith("[]\n")


def test_of_very_much_the_beginning_and_the_end_are_shown(cell: Cell) -> None:
    shown = cell("", "seq 1000000")
    assert len(shown) < 200_000
    assert "\n1\n2\n3\n" in shown
    assert "characters are left out here" in shown
    assert shown.endswith("\n999999\n1000000\n")


@pytest.mark.parametrize("options", ["--nonsense", "--timeout soon", "a b"])
def test_wrong_options_are_told_and_nothing_is_typed(cell: Cell, options: str) -> None:
    with pytest.raises(UsageError):
        cell(options, "touch was_run")
    assert "was_run" not in cell("", "ls")


def test_all_terminals_end_with_the_kernel(cell: Cell) -> None:
    cell("", "echo $PPID > pid")
    pid = int((Path(os.environ["ROS2LAB_WORK"]) / "pid").read_text())
    magic.close_all()
    with pytest.raises(ProcessLookupError):
        os.kill(pid, signal.SIG_DFL)
