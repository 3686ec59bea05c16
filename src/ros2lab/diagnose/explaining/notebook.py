"""Shows under a failed notebook cell the likeliest cause, its place and its fix."""

from __future__ import annotations

import dataclasses
import html
import linecache
import re
import traceback
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

    from ros2lab.diagnose.finding import Finding

_OWN_COMMAND = re.compile(
    r"\bros2lab\s"
)  # says itself what is wrong, and ends with 1 where it found something
_EXPLAIN_THEMSELVES = frozenset(("CheckError", "SystemExit", "WorkspaceError"))


def load_ipython_extension(shell: InteractiveShell) -> None:
    """Explain each cell that fails from now on; loading it twice does no harm."""
    unload_ipython_extension(shell)
    shell.events.register("post_run_cell", explain_cell)


def unload_ipython_extension(shell: InteractiveShell) -> None:
    """Stop explaining cells."""
    for known in [
        callback for callback in shell.events.callbacks["post_run_cell"] if callback is explain_cell
    ]:
        shell.events.unregister("post_run_cell", known)


def explain_cell(result: Any) -> None:
    """Show the first finding about a failed cell; do nothing after any other cell. Never raises."""
    error = result.error_in_exec or result.error_before_exec
    if error is None:
        return
    try:
        finding = find_cause(error)
        if finding is not None:
            from IPython.display import display

            shown = Explanation(finding, _then(error, finding), is_folded=_is_in_exercise(error))
            display(shown)  # type: ignore[no-untyped-call]
    except Exception:
        # The student has an error already; one of ours would not help.
        return


def find_cause(error: BaseException) -> Finding | None:
    """Return the likeliest cause of a cell's error; None if there is nothing to add to its message."""
    if type(error).__name__ in _EXPLAIN_THEMSELVES or isinstance(error, KeyboardInterrupt):
        return None
    from ros2lab.diagnose import of_text
    from ros2lab.diagnose.finding import SAID, UNKNOWN
    from ros2lab.diagnose.printed.error_text import read_error

    shown = getattr(error, "shown", None)  # what a terminal printed before its command failed
    if shown is not None:
        is_explained = not shown or any(map(_OWN_COMMAND.search, read_error(shown).typed[-1:]))
        findings = [] if is_explained else of_text(shown, _workspace_of(error.folder))  # type: ignore[attr-defined]
    else:
        text = "".join(traceback.format_exception(type(error), error, error.__traceback__))
        cells = _cells(error)
        findings = [_with_cells_named(finding, cells) for finding in of_text(text, sources=cells)]
    # A message that is only passed on is shown above already, unless there is something to type.
    is_typed = shown is not None
    # So are a cell's line and Python's message; and a cell displays the value of its last expression.
    is_above = {UNKNOWN, "python-error", "no-effect"} if shown is None else {UNKNOWN}
    return next(
        (f for f in findings if f.code not in is_above and (f.code != SAID or (f.fix and is_typed))), None
    )


def _cells(error: BaseException) -> dict[str, str]:
    """Return the sources of the cells in an error's traceback, by their file names there."""
    names = {frame.filename for frame in traceback.extract_tb(error.__traceback__)}
    if isinstance(error, SyntaxError) and error.filename:
        names.add(error.filename)
    texts = {name: "".join(linecache.getlines(name)) for name in sorted(names) if not Path(name).is_file()}
    return {name: text for name, text in texts.items() if text}


def _with_cells_named(finding: Finding, cells: Iterable[str]) -> Finding:
    """Return a finding with cells named as in IPython's traceback, and not by their file names."""
    cause, place, fix = finding.cause, finding.place, finding.fix
    for name in cells:
        shown = _name_of_cell(name)
        place = f"{shown}, line {place.rpartition(':')[2]}" if place.startswith(f"{name}:") else place
        cause, fix = cause.replace(name, shown), fix.replace(name, shown)
    return dataclasses.replace(finding, cause=cause, place=place, fix=fix)


def _name_of_cell(file: str) -> str:
    from IPython.core.getipython import get_ipython

    shell = get_ipython()
    name = shell.compile.format_code_name(file) if shell is not None else None
    return " ".join(name) if name else "this cell"


def _workspace_of(terminal_folder: str) -> Path | None:
    from ros2lab import course
    from ros2lab.diagnose.look import workspace_around

    folder = course.student_path(terminal_folder)
    return workspace_around(folder) if folder.is_dir() else None


def _then(error: BaseException, finding: Finding) -> str:
    """Return what must follow a fix of what a terminal printed: a build, where what runs is a copy."""
    from ros2lab.diagnose.packaging.installed import to_build

    root = _workspace_of(error.folder) if hasattr(error, "folder") else None
    return to_build(root.absolute(), [finding]) if root else ""


def _is_in_exercise(error: BaseException) -> bool:
    """Return whether a command failed in a workspace in which findings are told step by step."""
    from ros2lab import course
    from ros2lab.diagnose.explaining.steps import is_text_step_by_step

    shown = getattr(error, "shown", None)
    return shown is not None and is_text_step_by_step(shown, course.student_path(error.folder))  # type: ignore[attr-defined]


class Explanation:
    """A finding as a notebook shows it; if it is folded, all but its cause is hidden until it is clicked.

    Args:
        finding: the finding.
        then: the command that must follow the fix; empty if none must.
        is_folded: whether it is folded.
    """

    def __init__(self, finding: Finding, then: str = "", *, is_folded: bool = False) -> None:
        self.finding, self.then, self.is_folded = finding, then, is_folded

    @property
    def _rows(self) -> list[tuple[str, str]]:
        rows = [("Cause", self.finding.cause), ("Place", self.finding.place), ("Fix", self.finding.fix)]
        if self.then:
            rows.append(("Then", f"build again, for what runs is a copy of the source: {self.then}"))
        return [(name, text) for name, text in rows if text]

    def __repr__(self) -> str:
        return "\n".join(f"{name}: {text}" for name, text in self._rows[: 1 if self.is_folded else None])

    def _repr_html_(self) -> str:
        rows = "".join(
            self._row(name, text, is_folded=self.is_folded and number > 0)
            for number, (name, text) in enumerate(self._rows)
        )
        return f'<div role="note" style="border-left:4px solid #c77700;padding:0.3em 0.8em;margin:0.3em 0">{rows}</div>'

    @staticmethod
    def _row(name: str, text: str, *, is_folded: bool) -> str:
        # A class for each major version of MathJax, which would take $base … $base for a formula.
        classes = "mathjax_ignore tex2jax_ignore"
        shown = f'<span class="{classes}" style="white-space:pre-wrap">{html.escape(text)}</span>'
        if is_folded:
            return f"<details><summary><b>{name}</b></summary>{shown}</details>"
        return f"<div><b>{name}:</b> {shown}</div>"
