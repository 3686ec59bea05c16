"""A lab that somebody has opened: the server, and a notebook in a browser."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from place import Place
from playwright.sync_api import sync_playwright

sys.path.append(str(Path(__file__).parent.parent / "tests" / "browser"))
from browsing import Lab, Tab

CHROMIUM = "/usr/bin/chromium"
CHROMIUM_ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
OPEN_TIMEOUT = 120.0  # s
STOP_TIMEOUT = 60.0  # s


class Opened(NamedTuple):
    """A server that has printed its address, and how long that took in s."""

    address: str
    seconds: float


@contextlib.contextmanager
def opened_lab(
    command: Sequence[str], environ: Mapping[str, str], folder: Path, timeout: float = OPEN_TIMEOUT
) -> Iterator[Opened]:
    """Run a command until it prints the address of its JupyterLab; end it as Ctrl-C does.

    Raises:
        RuntimeError: with what it said instead of an address.
    """
    begin = time.monotonic()
    process = subprocess.Popen(
        command,
        env=environ,
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    too_late = threading.Timer(timeout, os.killpg, [process.pid, signal.SIGKILL])
    too_late.start()
    try:
        assert process.stdout is not None
        said = []
        for line in process.stdout:
            said.append(line)
            found = re.search(r"http://127\.0\.0\.1:\d+/\S*token=\w+", line)
            if found:
                break
        else:
            raise RuntimeError(f"{' '.join(command)} printed no address in {timeout:g} s:\n{''.join(said)}")
        too_late.cancel()
        yield Opened(found[0], time.monotonic() - begin)
    finally:
        too_late.cancel()
        _stop(process)


@contextlib.contextmanager
def opened_notebook(place: Place, name: str) -> Iterator[Tab]:
    """Open a notebook of a lab, in its server and in Chromium; yield its tab when the kernel rests."""
    command = ["ros2lab", "lab", "--folder", str(place.folder), "--port", "0", "--no-browser"]
    with opened_lab(command, place.environ, place.folder) as opened, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=CHROMIUM_ARGUMENTS)
        try:
            tab = Tab(browser.new_page(viewport={"width": 1280, "height": 900}))
            lab = Lab(opened.address, place.folder, place.environ)
            lab.solve()
            tab.page.goto(lab.notebook(name))
            tab.wait_until_ready()
            yield tab
        finally:
            browser.close()


def _stop(process: subprocess.Popen[str]) -> None:
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        if process.poll() is None:
            os.killpg(process.pid, number)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.communicate(timeout=STOP_TIMEOUT)
    if process.stdout:
        process.stdout.close()
