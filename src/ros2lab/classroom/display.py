"""What is shown while a class is graded: live in a terminal, else a line for each that has ended."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Literal

from rich.console import Console, Group
from rich.live import Live
from rich.progress import Progress
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from ros2lab.grading.reports.shown import visible

Form = Literal["usual", "quiet", "json"]

MOST_SHOWN = 20  # that are being graded
LONGEST_NAME = 40  # characters


@contextmanager
def bar(what: str) -> Iterator[Callable[[int, int], None]]:
    """Give a function that draws a progress bar of how many are done, and of how many; only in a terminal."""
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(what, total=None)
        yield lambda done, total: progress.update(task, completed=done, total=total)


class Display:
    """What is shown; a context manager."""

    def __init__(self, total: int, form: Form, clock: Callable[[], float] = time.monotonic) -> None:
        """Begin with so many that are to be graded."""
        self.total, self.done, self.failed = total, 0, 0
        self._form = form
        self._clock = clock
        self._start = clock()
        self._running: dict[str, tuple[str, str, float]] = {}
        console = Console(stderr=True)
        self._live = (
            Live(get_renderable=self._drawn, console=console, refresh_per_second=4, transient=True)
            if form == "usual" and console.is_terminal
            else None
        )

    def __enter__(self) -> Display:
        if self._live:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live:
            self._live.stop()

    @property
    def rate(self) -> float:
        """How many have been graded in a minute."""
        passed = self._clock() - self._start
        return 60 * self.done / passed if passed > 0 else 0.0

    @property
    def left(self) -> str:
        """How long the rest will take; empty while nobody can know."""
        if not self.done or not self.rate:
            return ""
        return _time(60 * (self.total - self.done) / self.rate)

    def step(self, key: str, name: str, text: str) -> None:
        """Show what is being done with one."""
        begun = self._running[key][2] if key in self._running else self._clock()
        self._running[key] = (name, text, begun)
        if self._form == "json":
            self._tell(event="step", name=name, step=text)

    def end(self, key: str, name: str, result: str, facts: Mapping[str, Any], *, has_failed: bool) -> None:
        """Show what has come of one: a sentence for people, and facts for programs."""
        *_, begun = self._running.pop(key, ("", "", self._clock()))
        self.done += 1
        self.failed += has_failed
        seconds = self._clock() - begun
        if self._form == "json":
            self._tell(
                event="done", name=name, **facts, seconds=round(seconds, 2), done=self.done, of=self.total
            )
            return
        if self._form == "quiet":
            return
        left = f", {self.left} left" if self.left and self.done < self.total else ""
        self._print(
            f"{self.done}/{self.total} {visible(name, LONGEST_NAME)}: {result} "
            f"({seconds:.0f} s; {self.rate:.1f} a minute{left})"
        )

    def warn(self, sentence: str) -> None:
        """Show what is wrong with something else than a submission."""
        if self._form == "json":
            self._tell(event="warning", text=sentence)
        else:
            self._print(visible(sentence))

    def _print(self, line: str) -> None:
        if self._live:
            self._live.console.print(Text(line))
        else:
            sys.stderr.write(f"{line}\n")

    def _tell(self, **event: Any) -> None:
        sys.stdout.write(f"{json.dumps(event)}\n")
        sys.stdout.flush()

    def _drawn(self) -> Group:
        table = Table.grid(padding=(0, 2))
        for name, text, begun in [*self._running.values()][:MOST_SHOWN]:
            table.add_row(
                Text(visible(name, LONGEST_NAME)), Text(visible(text, 60)), f"{self._clock() - begun:.0f} s"
            )
        failed = f", {self.failed} failed" if self.failed else ""
        left = f", {self.left} left" if self.left else ""
        line = Text(f"{self.done} of {self.total} done{failed}; {self.rate:.1f} a minute{left}")
        bar = Table.grid()
        bar.add_row(ProgressBar(total=self.total or 1, completed=self.done, width=60))
        return Group(table, bar, line)


def _time(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"
