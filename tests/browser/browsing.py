"""The lab, a tab of a browser, and a stranger who listens, as the browser tests use them."""

from __future__ import annotations

import json
import queue
import re
import signal
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import nbformat
from playwright.sync_api import ConsoleMessage, Error, Page, expect

from deadlines import DEADLINE
from ros2lab import course

TIMEOUT_MS = DEADLINE * 1000
LESSON_TIMEOUT_MS = 600_000


@dataclass
class Lab:
    """A running lab.

    Attributes:
        address: where it is, with its token.
        work: the student's folder.
        environ: the environment in which it runs.
        log: the file with what it prints, None if nobody keeps that.
    """

    address: str
    work: Path
    environ: dict[str, str]
    log: Path | None = None

    def solve(self) -> None:
        """Put the worked notebooks instead of the student edition, as somebody would who has solved everything.

        The sessions are still open: somebody is in the middle of a lesson.
        """
        for path in course.notebooks():
            text = path.read_text(encoding="utf-8").replace('"session.close()\\n"', '"session\\n"')
            (self.work / "notebooks" / path.name).write_text(text, encoding="utf-8")

    def write(self, name: str, cells: Sequence[str]) -> Path:
        """Write a notebook of code cells into the student's folder, and return where it is."""
        path = self.work / "notebooks" / name
        kernel = {"name": "python3", "display_name": "Python 3 (ipykernel)", "language": "python"}
        code_cells = [nbformat.v4.new_code_cell(cell) for cell in cells]
        nbformat.write(nbformat.v4.new_notebook(cells=code_cells, metadata={"kernelspec": kernel}), path)
        return path

    def end_kernels(self) -> None:
        """End all kernels, as closing the lab does."""
        for kernel in json.loads(self._ask("GET", "/api/kernels")):
            self._ask("DELETE", f"/api/kernels/{kernel['id']}")

    def set_theme(self, name: str) -> None:
        """Choose the theme of JupyterLab for pages that are opened from now on."""
        settings = json.dumps({"raw": json.dumps({"theme": name})})
        self._ask("PUT", "/lab/api/settings/@jupyterlab/apputils-extension:themes", settings.encode())

    def _ask(self, method: str, path: str, content: bytes | None = None) -> bytes:
        base, _, token = self.address.partition("/lab")
        request = urllib.request.Request(base + path, method=method, data=content)
        request.add_header("Authorization", f"token {token.partition('token=')[2]}")
        with urllib.request.urlopen(request, timeout=DEADLINE) as answer:
            return bytes(answer.read())

    def notebook(self, name: str) -> str:
        """Return the address of a notebook."""
        base, _, query = self.address.partition("?")
        return f"{base.partition('/lab')[0]}/lab/tree/notebooks/{name}?{query}"


@dataclass
class Tab:
    """A browser's tab with a notebook, and what its console complained of."""

    page: Page
    complaints: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.page.on("console", self._hear)
        self.page.on("pageerror", self._hear_error)

    def _hear(self, message: ConsoleMessage) -> None:
        if message.type == "error":
            self.complaints.append(f"{message.text} ({message.location.get('url')})")

    def _hear_error(self, error: Error) -> None:
        self.complaints.append(str(error))

    def menu(self, *names: str) -> None:
        """Choose an entry of a menu, by the beginning of its name."""
        for name in names:
            self.page.get_by_role("menuitem", name=re.compile(rf"^{re.escape(name)}")).first.click()

    def run_all(self, cells: int) -> None:
        """Run all cells, and wait until so many were executed without an error."""
        self.menu("Run", "Run All Cells")
        self.wait_until_executed(cells)

    def restart_and_run_all(self, cells: int) -> None:
        """Restart the kernel, run all cells, and wait until so many were executed without an error."""
        self.menu("Kernel", "Restart Kernel and Run All Cells")
        self.page.locator(".jp-Dialog button.jp-mod-accept").click()
        indicator = self.page.locator(".jp-Notebook-ExecutionIndicator").first
        expect(indicator).to_contain_text(re.compile(r"Executed \d+/\d+ cells"), timeout=TIMEOUT_MS)
        self.wait_until_executed(cells)

    def save(self) -> None:
        """Save the notebook, and wait until the server has it."""
        with self.page.expect_response(
            lambda response: response.request.method == "PUT" and "/api/contents/" in response.url,
            timeout=TIMEOUT_MS,
        ) as saved:
            self.menu("File", "Save Notebook")
        assert saved.value.ok

    def see_saved(self, selector: str) -> None:
        """Wait for a widget of a saved notebook, for which the page may have to be loaded a second time.

        If the kernel connects while JupyterLab reads the notebook's widgets, it takes them for lost: `restoreWidgets` of
        jupyterlab-widgets 3.0.17 counts as done when the kernel's widgets are read, and these are not yet.
        """
        widget, lost = (
            self.page.locator(selector).first,
            self.page.get_by_text("Error displaying widget").first,
        )
        expect(widget.or_(lost).first).to_be_visible(timeout=TIMEOUT_MS)
        if not widget.is_visible():
            self.page.reload()
        expect(widget).to_be_visible(timeout=TIMEOUT_MS)

    def scroll_to(self, selector: str) -> None:
        """Scroll to the first element that answers to a selector, once it is in the page."""
        self.page.locator(selector).first.scroll_into_view_if_needed(timeout=TIMEOUT_MS)

    def wait_until_ready(self) -> None:
        """Wait until the notebook is shown and its kernel has started and rests."""
        self.page.locator(".jp-Notebook .jp-CodeCell:visible").first.wait_for(timeout=TIMEOUT_MS)
        status_bar = self.page.locator("#jp-main-statusbar")
        expect(status_bar).to_contain_text("Python 3 (ipykernel) | Idle", timeout=TIMEOUT_MS)

    def wait_until_executed(self, cells: int) -> None:
        """Wait until the kernel rests and has executed so many cells; after an error it would be fewer."""
        indicator = self.page.locator('.jp-Notebook-ExecutionIndicator[data-status="idle"]')
        expect(indicator.first).to_contain_text(f"Executed {cells} cells", timeout=LESSON_TIMEOUT_MS)


def choose_theme(tab: Tab, name: str) -> None:
    """Choose a theme of JupyterLab, whose submenus are no menu items for a screen reader."""
    tab.menu("Settings")
    for entry in ("Theme", name):
        tab.page.locator(".lm-Menu-itemLabel", has_text=re.compile(f"^{entry}$")).click()
    tab.page.locator(f'body[data-jp-theme-name="{name}"]').wait_for(state="attached")


class Stranger:
    """A process that has nothing to do with the notebook and listens to the robot's topics."""

    def __init__(self, environ: dict[str, str]) -> None:
        self._process = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("stranger.py"))],
            env=environ,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._heard: queue.Queue[dict[str, Any]] = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def wait_for(self, kind: str, is_it: Callable[[Any], bool], timeout: float = DEADLINE) -> Any:
        """Wait for a line of a kind whose value satisfies `is_it`, and return the value.

        Raises:
            AssertionError: with what came instead.
        """
        deadline = time.monotonic() + timeout
        others = []
        while True:
            try:
                line = self._heard.get(timeout=max(0.0, deadline - time.monotonic()))
            except queue.Empty:
                raise AssertionError(f"no such {kind} within {timeout} s; heard: {others[-20:]}") from None
            if line["kind"] == kind and is_it(line["value"]):
                return line["value"]
            others.append(line)

    def close(self) -> None:
        """End the process."""
        self._process.send_signal(signal.SIGINT)
        self._process.wait(DEADLINE)
        self._reader.join(DEADLINE)

    def _read(self) -> None:
        assert self._process.stdout is not None
        with self._process.stdout as lines:
            for line in lines:
                self._heard.put(json.loads(line))
