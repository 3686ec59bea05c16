"""`ros2lab dashboard` as somebody meets it who has no notebook: nodes of other processes, a page, and Ctrl-C."""

from __future__ import annotations

import contextlib
import itertools
import os
import re
import signal
import subprocess
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest
from browsing import TIMEOUT_MS, Stranger, Tab
from driving import height_of_line, press, see_state, show_the_whole_drive, wait_for_picture
from playwright.sync_api import Browser, Page, expect

from deadlines import DEADLINE
from ros2lab import course, environment
from ros2lab.workspace import Workspace

pytestmark = pytest.mark.long

OVERLAPS = """() => {
  const boxes = [...document.querySelectorAll(".ros2lab-tiles > *")].map((tile) => tile.getBoundingClientRect());
  const inner = document.documentElement;
  return {
    tiles: boxes.map(({ left, right, top, bottom }) => ({ left, right, top, bottom })),
    page: { width: inner.scrollWidth, height: inner.scrollHeight },
    // What is cut off at the right in a tile, or would need a scroll bar there.
    wide: [...document.querySelectorAll(".ros2lab-tiles > *, .ros2lab-tiles, .ros2lab-dashboard")]
      .filter((part) => part.scrollWidth > part.clientWidth + 1).map((part) => part.className),
  };
}"""


class Server:
    """A `ros2lab dashboard` that has printed its address."""

    def __init__(self, environ: dict[str, str], *options: str) -> None:
        self.process = subprocess.Popen(
            ["ros2lab", "dashboard", "--no-browser", *options],
            env=environ,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.said = ""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.said += line
            if found := re.search(r"http://127\.0\.0\.1:(\d+)/dashboard\?token=\w+", line):
                self.address, self.port = found[0], int(found[1])
                return
        raise AssertionError(f"no address:\n{self.said}")

    def processes(self) -> list[psutil.Process]:
        """Return its kernels and what they started."""
        return psutil.Process(self.process.pid).children(recursive=True)

    def status(self, path: str) -> int:
        """Ask for a page without the token, and return the status of the answer to which that leads."""
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{self.port}{path}", timeout=DEADLINE) as answer:
                return int(answer.status)
        except urllib.error.HTTPError as error:
            with error:
                return error.code

    def close(self, number: int = signal.SIGINT) -> int:
        """Send a signal; return the exit code."""
        if self.process.poll() is None:
            self.process.send_signal(number)
        output, _ = self.process.communicate(timeout=DEADLINE)
        self.said += output
        return self.process.returncode


@pytest.fixture
def environ(domain_id: int) -> dict[str, str]:
    return {**environment.lab_environment(), "ROS_DOMAIN_ID": str(domain_id)}


@pytest.fixture
def open_dashboard(environ: dict[str, str]) -> Iterator[Callable[..., Server]]:
    """Return a function that starts the command."""
    with contextlib.ExitStack() as stack:

        def open_server(*options: str) -> Server:
            server = Server(environ, *options)
            stack.callback(server.close)
            return server

        yield open_server


@pytest.fixture
def open_page(browser: Browser) -> Iterator[Callable[..., Tab]]:
    """Return a function that opens an address in a browser of its own, and waits until the dashboard is there."""
    with contextlib.ExitStack() as stack:

        def open_address(address: str, width: int = 1280, height: int = 800, **options: Any) -> Tab:
            context = browser.new_context(viewport={"width": width, "height": height}, **options)
            context.set_default_timeout(TIMEOUT_MS)
            stack.callback(context.close)
            tab = Tab(context.new_page())
            tab.page.goto(address)
            wait_for_dashboard(tab.page)
            return tab

        yield open_address


@pytest.fixture
def other_stranger(environ: dict[str, str]) -> Iterator[Stranger]:
    """Start a stranger in the domain of the test."""
    listener = Stranger(environ)
    listener.wait_for("ready", bool)
    yield listener
    listener.close()


@pytest.fixture
def start_robot(tmp_path: Path, domain_id: int) -> Iterator[Callable[[], None]]:
    """Return a function that starts the reference nodes, each in a process of its own."""
    workspace = Workspace(course.copy_reference(tmp_path, has_tests=False))
    workspace.build(show=False)
    environ = {**workspace.overlay, "ROS_DOMAIN_ID": str(domain_id)}
    processes: list[subprocess.Popen[bytes]] = []

    def start() -> None:
        for executable in workspace.executables():
            command = [str(executable.path)]
            processes.append(
                subprocess.Popen(command, env=environ, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            )

    yield start
    for process in processes:
        process.send_signal(signal.SIGINT)
    for process in processes:
        process.wait(DEADLINE)


def wait_for_dashboard(page: Page) -> None:
    """Wait until the page shows all five widgets."""
    expect(page.locator(".ros2lab-tiles > *")).to_have_count(5, timeout=TIMEOUT_MS)
    page.locator(".ros2lab-panel").wait_for(timeout=TIMEOUT_MS)


def see_listeners(tab: Tab) -> None:
    """Wait until the panel knows of both who listen: a command goes to those that the graph shows."""
    expect(tab.page.locator(".ros2lab-panel")).to_contain_text("2 nodes listen.", timeout=TIMEOUT_MS)


def see_no_overlap(page: Page, width: int, height: int | None = None) -> None:
    """See that nothing lies over anything else, and that nothing has to be scrolled to the side."""
    seen = page.evaluate(OVERLAPS)
    assert seen["wide"] == []
    assert seen["page"]["width"] <= width
    if height is not None:
        assert seen["page"]["height"] <= height
    for tile in seen["tiles"]:
        assert 0 <= tile["left"] < tile["right"] <= width
    for one, other in itertools.combinations(seen["tiles"], 2):
        is_apart = (
            one["right"] <= other["left"]
            or other["right"] <= one["left"]
            or one["bottom"] <= other["top"]
            or other["bottom"] <= one["top"]
        )
        assert is_apart, (one, other)


def take_picture(page: Page, name: str) -> None:
    """Take a picture for README, if PICTURES names a folder."""
    if folder := os.environ.get("PICTURES"):
        page.screenshot(path=Path(folder) / f"{name}.png", full_page=True)


@pytest.mark.thorough
def test_a_robot_of_other_processes_is_driven_from_the_page(
    open_dashboard: Callable[..., Server],
    open_page: Callable[..., Tab],
    other_stranger: Stranger,
    start_robot: Callable[[], None],
) -> None:
    """It is opened while nothing runs, and follows; two tabs see the same; closed and opened again it goes on."""
    server = open_dashboard()
    tab = open_page(server.address)
    assert "token" not in tab.page.url
    note = tab.page.locator(".ros2lab-dashboard > * [role=status]").first
    expect(note).to_contain_text(": /stranger.", timeout=TIMEOUT_MS)
    start_robot()
    expect(note).to_contain_text("/velocity_publisher", timeout=TIMEOUT_MS)
    see_listeners(tab)
    plot = tab.page.locator(".ros2lab-place-plot")
    show_the_whole_drive(tab)
    press(tab, "start")
    other_stranger.wait_for("command", lambda word: word == "start")
    other_stranger.wait_for("velocity", lambda velocity: velocity[0] > 0)
    see_state(tab, "running")
    expect(plot.get_by_role("img", name="0.50 m/s")).to_be_visible(timeout=TIMEOUT_MS)
    wait_for_picture(lambda: height_of_line(tab) > 30, "the line has risen")
    expect(tab.page.locator("table.ros2lab-log")).to_contain_text("Received 'start'")
    take_picture(tab.page, "dashboard")
    see_no_overlap(tab.page, 1280, 800)

    narrow = open_page(server.address, 620, 900, color_scheme="dark")
    see_state(narrow, "running")
    robot_moves = narrow.page.locator(".ros2lab-place-plot").get_by_role("img", name="0.50 m/s")
    expect(robot_moves).to_be_visible(timeout=TIMEOUT_MS)
    take_picture(narrow.page, "dashboard_narrow")
    see_no_overlap(narrow.page, 620)
    see_listeners(narrow)
    press(narrow, "stop")
    other_stranger.wait_for("command", lambda word: word == "stop")
    see_state(tab, "stopped")
    see_state(narrow, "stopped")

    kernels = server.processes()
    narrow.page.close()
    tab.page.goto("about:blank")
    psutil.wait_procs(kernels, timeout=DEADLINE)
    assert [process for process in kernels if process.is_running()] == [], "a closed page leaves no kernel"
    again = open_page(server.address)
    see_state(again, "stopped")
    see_listeners(again)
    press(again, "start")
    other_stranger.wait_for("command", lambda word: word == "start")
    assert [*tab.complaints, *narrow.complaints, *again.complaints] == []

    kernels = server.processes()
    assert kernels
    assert server.close() == 0
    assert server.said.splitlines()[-1] == "The dashboard is closed."
    assert not re.search("Traceback|Error|Warning", server.said)
    assert [process for process in kernels if process.is_running()] == []


@pytest.mark.parametrize("scheme", ["dark", pytest.param("light", marks=pytest.mark.thorough)])
def test_it_has_the_theme_that_the_browser_prefers_and_asks_nothing_of_the_internet(
    open_dashboard: Callable[..., Server], browser: Browser, scheme: str
) -> None:
    """And without its token it opens for nobody."""
    server = open_dashboard()
    see_no_way_in(server)
    with browser.new_context(color_scheme=scheme) as context:
        context.set_default_timeout(TIMEOUT_MS)
        page = context.new_page()
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.goto(server.address)
        wait_for_dashboard(page)
        expect(page.locator(".ros2lab-dashboard")).to_contain_text("nothing runs yet", timeout=TIMEOUT_MS)
        colour = page.locator(".ros2lab-panel").evaluate("(card) => getComputedStyle(card).backgroundColor")
    lightness = sum(map(int, re.findall(r"\d+", colour)[:3]))
    assert lightness < 200 if scheme == "dark" else lightness > 600
    local = ("http://127.0.0.1:", "data:", "blob:")
    assert [address for address in asked if not address.startswith(local)] == []


def see_no_way_in(server: Server) -> None:
    """Without the token everything is refused, and nobody on another computer reaches it at all."""
    page = "/voila/render/ROS%202%20dashboard.ipynb"
    wrong = f"/dashboard?token={'0' * 48}"
    for path in ("/", "/dashboard", wrong, page, "/api/kernels", "/api/contents"):
        assert server.status(path) == 403, path
    assert server.processes() == []
    connections = psutil.Process(server.process.pid).net_connections("inet")
    assert {one.laddr.ip for one in connections if one.status == psutil.CONN_LISTEN} == {"127.0.0.1"}


@pytest.mark.thorough
def test_a_second_one_takes_another_port(open_dashboard: Callable[..., Server]) -> None:
    """Each closes by itself, also when it is killed or its terminal is closed."""
    first, second = open_dashboard(), open_dashboard("--domain", "77")
    assert first.port != second.port
    assert second.said.startswith("ROS domain 77:")
    assert first.close(signal.SIGTERM) == 0
    assert first.said.splitlines()[-1] == "The dashboard is closed."
    assert second.status("/dashboard") == 403
    assert second.close(signal.SIGHUP) == 0
    assert second.said.splitlines()[-1] == "The dashboard is closed."
