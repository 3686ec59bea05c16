"""The cell magic `%%terminal`, and the function `terminal` that gives the terminal itself."""

from __future__ import annotations

import atexit
import os
import sys
from typing import TYPE_CHECKING, Any

from IPython.core.magic_arguments import argument, magic_arguments, parse_argstring

from ros2lab import edition, environment, neighbours
from ros2lab.diagnose.explaining import notebook
from ros2lab.interrupts import interrupted_says
from ros2lab.terminal.bash import Terminal, TerminalError
from ros2lab.terminal.editor import save_cell

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

LONGEST_SHOWN = 100_000  # characters of one cell; a page with more becomes slow
TAIL_SHOWN = 5_000  # characters
LONGEST_ERROR = 20_000  # characters
DEFAULT_TIMEOUT = 600.0  # s

_terminals: dict[str, Terminal] = {}


def load_ipython_extension(shell: InteractiveShell) -> None:
    """Offer `%%terminal`, `terminal()` and `%%editor` in a notebook, and explain cells that fail.

    The terminals end with the kernel.
    """
    notebook.load_ipython_extension(shell)
    register: Any = shell.register_magic_function  # whose type has lost that it is bound
    register(run_cell, "cell", "terminal")
    register(save_cell, "cell", "editor")
    shell.push({"terminal": terminal})
    atexit.unregister(close_all)
    atexit.register(close_all)


def terminal(name: str = "1") -> Terminal:
    """Return the terminal of a name; it is made if there is none, or if its shell has ended."""
    if name not in _terminals or not _terminals[name].is_open:
        _terminals[name] = Terminal(name)
    return _terminals[name]


def terminals() -> dict[str, Terminal]:
    """Return the terminals of this notebook, by their names."""
    return dict(_terminals)


def close_all() -> None:
    """End every terminal."""
    while _terminals:
        _terminals.popitem()[1].close()


@magic_arguments()
@argument("name", nargs="?", default="1", help="which terminal; each name has its own (default: 1)")
@argument("--expect-error", action="store_true", help="the cell is right if a command in it fails")
@argument("--timeout", type=float, default=DEFAULT_TIMEOUT, help="the longest time for the cell, in s")
@argument("--background", action="store_true", help="leave the last line running")
def run_cell(line: str, cell: str) -> None:
    """Run the lines in a bash that stays open: `cd`, `source`, variables and jobs hold in the next cell."""
    options = parse_argstring(run_cell, line)
    known = _terminals.get(options.name)
    if known is not None and not known.is_open:
        _write(
            f"The shell of terminal {options.name} had ended. This is a new one: nothing is sourced in it.\n"
        )
    opened = terminal(options.name)
    if options.background and opened.is_busy:
        opened.interrupt()  # the cell is run again: it replaces, and does not double
    if options.background:
        _write(_notice())
    page = _Page()
    try:
        with interrupted_says(
            f"what ran in terminal {options.name} was stopped; the terminal can be used again."
        ):
            codes = opened.run(
                cell.splitlines(),
                page.show,
                timeout=options.timeout,
                goes_on=options.expect_error,
                in_background=options.background,
            )
    except TerminalError as error:
        error.shown, error.folder = page.end_of_text(), opened.folder
        raise
    finally:
        page.end(options.name)
    is_blank = edition.STUB in cell or not codes
    if options.expect_error and not any(codes) and not is_blank:
        raise TerminalError("A command of this cell should have failed, and all of them succeeded.")


def _notice() -> str:
    """Say which other notebooks and terminals have nodes where this one is about to start some."""
    domain = {**environment.lab_settings(), **os.environ}["ROS_DOMAIN_ID"]
    return neighbours.notice(neighbours.neighbours(int(domain)), "") if domain.isdigit() else ""


class _Page:
    """What a notebook shows of a cell: everything, or if that is too much, its beginning and its end."""

    def __init__(self) -> None:
        self._shown = 0
        self._left_out = 0
        self._tail = ""
        self._newest = ""

    def show(self, text: str) -> None:
        self._newest = (self._newest + text)[-LONGEST_ERROR:]
        now = text[: max(0, LONGEST_SHOWN - self._shown)]
        later = text[len(now) :]
        self._shown += len(now)
        self._tail += later
        if len(self._tail) > TAIL_SHOWN:
            self._left_out += len(self._tail) - TAIL_SHOWN
            self._tail = self._tail[-TAIL_SHOWN:]
        _write(now)

    def end_of_text(self) -> str:
        """Return the last of what was shown, in which an error stands."""
        return self._newest

    def end(self, name: str) -> None:
        if self._left_out:
            _write(
                f"\n[{self._left_out:,} characters are left out here; "
                f"terminal({name!r}).read() has the newest million]\n"
            )
        _write(self._tail)


def _write(text: str) -> None:
    sys.stdout.write(text)
    sys.stdout.flush()
