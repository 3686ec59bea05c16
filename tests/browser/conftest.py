"""A lab that runs, a browser that looks at it, and a stranger who listens."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from browsing import TIMEOUT_MS, Lab, Stranger, Tab
from playwright.sync_api import Browser, expect, sync_playwright

from bare_student import free_port, wait_for_address
from deadlines import DEADLINE
from ros2lab import environment

CHROMIUM = "/usr/bin/chromium"
CHROMIUM_ARGUMENTS = [
    "--no-sandbox",  # root, as in CI, has no other way
    "--disable-gpu",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]

expect.set_options(timeout=TIMEOUT_MS)


@pytest.fixture
def lab(tmp_path: Path, domain_id: int) -> Iterator[Lab]:
    """Start the server that `make lab` starts, in a student's folder of its own."""
    work = tmp_path / "student's work"
    environ = {**environment.lab_environment(), "ROS_DOMAIN_ID": str(domain_id)}
    command = ["ros2lab", "lab", "--folder", str(work), "--port", str(free_port()), "--no-browser"]
    log = tmp_path / "lab.log"
    with log.open("w") as output:
        process = subprocess.Popen(
            command, env=environ, stdout=output, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL
        )
    try:
        yield Lab(wait_for_address(log, process), work, environ, log)
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(DEADLINE)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Return Debian's Chromium."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=CHROMIUM, args=CHROMIUM_ARGUMENTS, timeout=TIMEOUT_MS
        )
        yield browser
        browser.close()


@pytest.fixture
def open_tab(browser: Browser, lab: Lab) -> Iterator[Callable[[str], Tab]]:
    """Return a function that opens a notebook in a tab of its own."""
    contexts: list[Any] = []

    def open_notebook(name: str, lab: Lab = lab, **options: Any) -> Tab:
        context = browser.new_context(viewport={"width": 1280, "height": 900}, **options)
        context.set_default_timeout(TIMEOUT_MS)
        contexts.append(context)
        tab = Tab(context.new_page())
        tab.page.goto(lab.notebook(name))
        tab.wait_until_ready()
        return tab

    yield open_notebook
    for context in contexts:
        context.close()


@pytest.fixture
def stranger(lab: Lab) -> Iterator[Stranger]:
    """Start a stranger in the lab's domain."""
    listener = Stranger(lab.environ)
    listener.wait_for("ready", bool)
    yield listener
    listener.close()


@pytest.fixture
def pictures() -> Path | None:
    """Return the folder for pictures that README shows, if PICTURES names one."""
    folder = os.environ.get("PICTURES")
    return Path(folder) if folder else None
