"""`ros2lab lab` as a student meets it: a real JupyterLab in a folder of one's own."""

from __future__ import annotations

import contextlib
import hashlib
import http.client
import json
import os
import pty
import re
import signal
import socket
import subprocess
import sys
import sysconfig
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest
import websocket
from jupyter_client import BlockingKernelClient

from deadlines import DEADLINE
from ros2lab import course, environment, jupyter_settings
from ros2lab.terminal import Terminal
from ros2lab.verbs import lab

COMMAND = str(Path(sysconfig.get_path("scripts"), "ros2lab"))


class OpenLab:
    """A lab that has printed its address."""

    def __init__(self, work: Path, home: Path, *, has_terminal: bool = True) -> None:
        # On a terminal, because that is where Jupyter's own Ctrl-C asks back.
        self._keyboard, terminal = pty.openpty()
        self.process = subprocess.Popen(
            [COMMAND, "lab", "--folder", str(work), "--port", "0", "--no-browser"],
            env={**os.environ, "HOME": str(home)},
            stdin=terminal if has_terminal else subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=not has_terminal,
        )
        os.close(terminal)
        self.said = ""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.said += line
            found = re.search(r"http://127\.0\.0\.1:(\d+)/lab\S*\?token=(\w+)", line)
            if found:
                self.address = found[0]
                self.server = lab.Server(int(found[1]), found[2])
                return
        raise AssertionError(f"no address:\n{self.said}")

    def get(
        self, path: str, method: str = "GET", body: object = None, *, token: str | None = None
    ) -> tuple[int, str]:
        """Ask the server; return the status and the body."""
        connection = http.client.HTTPConnection("127.0.0.1", self.server.port, timeout=DEADLINE)
        with contextlib.closing(connection):
            headers = {"Authorization": f"token {self.server.token if token is None else token}"}
            content = None if body is None else json.dumps(body)
            connection.request(method, path, body=content, headers=headers)
            answer = connection.getresponse()
            return answer.status, answer.read().decode()

    def close(self, number: int = signal.SIGINT) -> int:
        """Send a signal; return the exit code."""
        if self.process.poll() is None:
            self.process.send_signal(number)
        output, _ = self.process.communicate(timeout=DEADLINE)
        self.said += output
        with contextlib.suppress(OSError):
            os.close(self._keyboard)
        return self.process.returncode


@pytest.fixture
def home(tmp_path: Path) -> Path:
    """A home folder with a Jupyter configuration that would break every server."""
    return make_home(tmp_path / "home")


def make_home(home: Path) -> Path:
    """Write that configuration into a new home."""
    (home / ".jupyter").mkdir(parents=True)
    (home / ".jupyter" / "jupyter_server_config.py").write_text("raise RuntimeError('of another server')")
    (home / ".jupyter" / "jupyter_server_config.json").write_text('{"ServerApp": {"ip": "0.0.0.0"}}')
    return home


@pytest.fixture
def open_lab(tmp_path: Path, home: Path) -> Iterator[Callable[[], OpenLab]]:
    """Return a function that opens the lab in a folder of this test."""
    labs: list[OpenLab] = []

    def open_one() -> OpenLab:
        labs.append(OpenLab(tmp_path / "mein Kurs ü", home))
        return labs[-1]

    yield open_one
    for one in labs:
        one.close()


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[OpenLab]:
    """A lab that tests only look at."""
    folder = tmp_path_factory.mktemp("looked_at")
    opened = OpenLab(folder / "work", make_home(folder / "home"))
    yield opened
    opened.close()


@pytest.mark.parametrize(
    "number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.thorough), signal.SIGHUP]
)
def test_it_opens_at_the_printed_address_and_closes_quietly(
    open_lab: Callable[[], OpenLab], home: Path, number: int
) -> None:
    """Ctrl-C, `kill` and the closing of the terminal; ~/.jupyter is neither read nor written."""
    before = _tree(home)
    opened = open_lab()
    assert opened.get("/lab")[0] == 200
    assert opened.get("/api/contents", token="")[0] == 403
    assert opened.get("/")[0] == 302
    connections = psutil.Process(opened.process.pid).net_connections("inet")
    assert {one.laddr.ip for one in connections if one.status == psutil.CONN_LISTEN} == {"127.0.0.1"}
    assert opened.close(number) == 0
    assert opened.said.splitlines()[-1] == "The lab is closed."
    assert not re.search("Traceback|Error|Warning|[Ss]hut", opened.said)
    assert _tree(home) == before


@pytest.mark.thorough  # mybinder does, and no student
def test_who_starts_it_may_say_where_it_listens_and_who_may_enter(tmp_path: Path, home: Path) -> None:
    """So mybinder does, on a JupyterHub of which the lab then knows nothing."""
    place = [
        "--ip=127.0.0.1",
        "--port=0",
        "--ServerApp.base_url=/user/guest/",
        "--ServerApp.token=of-a-guest",
    ]
    with subprocess.Popen(
        [COMMAND, "lab", "--folder", str(tmp_path / "work"), "--no-browser", "--", *place],
        env={**os.environ, "HOME": str(home), "JUPYTERHUB_SERVICE_URL": "http://127.0.0.1:1/user/guest/"},
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        found = (re.search(r"http://127\.0\.0\.1:(\d+)/user/guest/lab", line) for line in process.stdout)
        port = int(next(match[1] for match in found if match))
        statuses = []
        for token in ("of-a-guest", "wrong"):
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=DEADLINE)
            with contextlib.closing(connection):
                connection.request("GET", f"/user/guest/api/contents/{course.LESSONS}?token={token}")
                statuses.append(connection.getresponse().status)
        assert statuses == [200, 403]
        process.terminate()
        assert process.wait(DEADLINE) == 0


def test_nothing_asks_the_internet_for_news_and_updates(opened: OpenLab) -> None:
    page = opened.get("/lab")[1]
    assert re.search(r'"news":\s*{"disabled":\s*true}', page)
    assert json.loads(opened.get("/lab/api/news")[1]) == {"news": []}
    assert json.loads(opened.get("/lab/api/update")[1]) == {"notification": None}


def test_the_side_bar_shows_progress_before_any_kernel_runs(opened: OpenLab) -> None:
    """Its extension is newly asked for after an update of the course; nobody without the token sees anything."""
    status, answer = opened.get("/ros2lab/progress")
    assert status == 200
    assert json.loads(answer)["next"] == "notebooks/00_welcome.ipynb"
    assert opened.get("/ros2lab/progress", token="")[0] == 403
    assert json.loads(opened.get("/api/kernels")[1]) == []
    assert "ros2lab-progress" in opened.get("/lab")[1]
    script = "/lab/extensions/ros2lab-progress/progress.js"
    assert "_JUPYTERLAB" in opened.get(script)[1]
    with urllib.request.urlopen(f"http://127.0.0.1:{opened.server.port}{script}", timeout=DEADLINE) as head:
        assert head.headers["Cache-Control"] == "no-cache"


def test_every_cell_of_a_lesson_is_in_the_page(opened: OpenLab) -> None:
    """Also one that is out of sight; the student may choose otherwise."""
    answer = json.loads(opened.get("/lab/api/settings/@jupyterlab/notebook-extension:tracker")[1])
    assert answer["schema"]["properties"]["windowingMode"]["default"] == "defer"
    assert answer["settings"] == {}


def test_what_only_makers_of_a_course_need_is_not_there(opened: OpenLab) -> None:
    """The student edition is made by nbgrader, the dashboard by voila; both would bring menus and pages."""
    disabled = re.search(r'"disabledExtensions":\s*\[([^]]*)\]', opened.get("/lab")[1])
    assert disabled
    assert "@jupyter/nbgrader" in disabled[1]
    assert "@voila-dashboards/jupyterlab-preview" in disabled[1]
    assert opened.get("/formgrader")[0] == 404
    assert opened.get("/tree")[0] == 404
    assert opened.get("/voila")[0] == 404


def test_the_second_time_it_changes_nothing(open_lab: Callable[[], OpenLab], tmp_path: Path) -> None:
    first = open_lab()
    first.close()
    work = tmp_path / "mein Kurs ü"
    count = len(course.notebooks())
    assert f"notebooks: {count} new, 0 kept" in first.said
    changed = work / "notebooks" / course.notebooks()[0].name
    changed.write_text("mine")
    before = _tree(work)
    second = open_lab()
    second.close()
    assert f"notebooks: 0 new, {count} kept" in second.said
    assert changed.read_text() == "mine"
    assert _tree(work) == before


def test_a_lab_that_runs_already_is_named_and_one_that_was_killed_is_not(
    open_lab: Callable[[], OpenLab],
) -> None:
    first, second = open_lab(), open_lab()
    assert second.process.wait(DEADLINE) == 0
    assert second.address == first.address
    assert "already running" in second.said
    assert first.get("/lab")[0] == 200
    first.process.kill()
    first.close()
    third = open_lab()
    assert "already running" not in third.said
    assert third.close() == 0


def test_its_kernels_have_the_lab_and_end_with_it(open_lab: Callable[[], OpenLab], tmp_path: Path) -> None:
    opened = open_lab()
    status, body = opened.get("/api/kernels", "POST")
    assert status == 201, body
    [kernel] = psutil.Process(opened.process.pid).children()
    [file] = jupyter_settings.runtime_folder(tmp_path / "mein Kurs ü").glob("kernel-*.json")
    code = (
        "import os, shutil, sys, rclpy\n"
        "print(sys.executable, shutil.which('ros2lab'), os.environ['ROS2LAB_WORK'],"
        " os.environ['ROS_DOMAIN_ID'], sep='\\n')"
    )
    assert _run(file, code).splitlines() == [
        sys.executable,
        COMMAND,
        str(tmp_path / "mein Kurs ü"),
        os.environ["ROS_DOMAIN_ID"],
    ]
    assert opened.close() == 0
    assert not kernel.is_running()


class LabTerminal:
    """A terminal of JupyterLab, as its page uses it."""

    def __init__(self, opened: OpenLab, folder: str) -> None:
        name = json.loads(opened.get("/api/terminals", "POST", {"cwd": folder})[1])["name"]
        self._socket = websocket.create_connection(
            f"ws://127.0.0.1:{opened.server.port}/terminals/websocket/{name}",
            header=[f"Authorization: token {opened.server.token}"],
            timeout=DEADLINE,
        )

    def wait_for(self, text: str) -> str:
        """Return what comes up to a text, without colours."""
        came = ""
        while text not in came:
            kind, *content = json.loads(self._socket.recv())
            came += content[0] if kind == "stdout" else ""
            came = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", came)
        return came

    def type(self, keys: str) -> None:
        """Press keys."""
        self._socket.send(json.dumps(["stdin", keys]))

    def close(self) -> None:
        """Close the page, not the terminal."""
        self._socket.close()


def test_its_terminals_are_the_world_of_the_notebooks(
    tmp_path: Path, home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a terminal of its own, in a user's environment that knows nothing of the lab, in zsh."""
    work = tmp_path / "mein Kurs ü"
    domain = os.environ["ROS_DOMAIN_ID"]
    for name in list(os.environ):
        if name not in ("PATH", "LANG", "ROS_DOMAIN_ID"):
            monkeypatch.delenv(name)
    monkeypatch.setenv("PATH", os.defpath)
    monkeypatch.setenv("SHELL", "/usr/bin/zsh")
    monkeypatch.setenv("HOME", str(home))
    opened = OpenLab(work, home, has_terminal=False)
    try:
        terminal = LabTerminal(opened, "notebooks")
        assert terminal.wait_for("$ ") == "lab:~$ "
        terminal.type("env -0 > environment; type -P ros2 colcon; pwd; ros2 topic list; echo E'nd'\r")
        said = terminal.wait_for("End\r\n").partition("End\r\n")[0].splitlines()
        scripts = Path(sysconfig.get_path("scripts"))
        topics = ["/parameter_events", "/rosout"]
        assert said[-5:] == [str(scripts / "ros2"), str(scripts / "colcon"), str(work), *topics]
        for line, offered in (("ros2 topic e\t", "cho "), ("-\x15colcon buil\t", "d ")):
            terminal.type(line)
            terminal.wait_for(offered)
        terminal.type("\x15mkdir ros2_ws && cd ros2_ws\r")
        terminal.wait_for("lab:~/ros2_ws$ ")
        terminal.close()
    finally:
        opened.close()
    theirs = environment.parse_environment((work / "environment").read_bytes())
    monkeypatch.setenv("ROS2LAB_WORK", str(work))
    with contextlib.closing(Terminal()) as notebooks:
        ours = notebooks.environ()
    shared = ("HOME", "PATH", "ROS2LAB_WORK", "LC_MESSAGES", "GIT_CEILING_DIRECTORIES", "GIT_CONFIG_GLOBAL")
    shared += tuple(name for name in ours if name.startswith(("ROS_", "RCUTILS_", "FASTRTPS_")))
    assert {name: theirs.get(name) for name in shared} == {name: ours.get(name) for name in shared}
    assert theirs["ROS_DOMAIN_ID"] == domain


WAITING = """
import asyncio
import anyio.to_thread
from jupyter_server.base.handlers import JupyterHandler

class Waiting(JupyterHandler):
    async def get(self):
        await anyio.to_thread.run_sync(int)
        self.write("waiting")
        await self.flush()
        await asyncio.Event().wait()

def _load_jupyter_server_extension(app):
    app.web_app.add_handlers(".*", [("/waiting", Waiting)])
"""


@pytest.mark.thorough
def test_it_closes_while_a_request_is_in_progress(
    open_lab: Callable[[], OpenLab], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A page that is open asks for files at any time, and threads read them."""
    (tmp_path / "waiting.py").write_text(WAITING)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    settings = tmp_path / "mein Kurs ü" / ".jupyter" / "config" / "jupyter_server_config.d"
    settings.mkdir(parents=True)
    extension = {"ServerApp": {"jpserver_extensions": {"waiting": True}}}
    (settings / "waiting.json").write_text(json.dumps(extension))
    opened = open_lab()
    connection = http.client.HTTPConnection("127.0.0.1", opened.server.port, timeout=DEADLINE)
    with contextlib.closing(connection):
        connection.request("GET", "/waiting", headers={"Authorization": f"token {opened.server.token}"})
        assert connection.getresponse().read(7) == b"waiting"
        assert opened.close() == 0
    assert opened.said.splitlines()[-1] == "The lab is closed."


@pytest.mark.thorough
def test_jupyterlab_is_imported_without_asking_other_programs() -> None:
    """Such as a Node.js in /usr/bin, whose settings only building JupyterLab would need."""
    source = """
import sys
from ros2lab.verbs import lab
sys.addaudithook(lambda event, given: event == "subprocess.Popen" and print(given[1], flush=True))
lab._import_lab_app()
"""
    finished = subprocess.run([sys.executable, "-c", source], capture_output=True, text=True, check=True)
    assert finished.stdout == ""


def test_a_port_in_use_is_one_sentence(tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        finished = _finish("--folder", str(tmp_path / "work"), "--port", str(port))
    assert finished.returncode == 1
    assert re.fullmatch(
        rf"Port {port} is used by another program: run `make lab PORT=\d+`\.\n", finished.stderr
    )


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    finished = _finish("--folder", str(tmp_path / "file" / "work"))
    assert finished.returncode == 1
    assert "ROS2LAB_WORK=" in finished.stderr
    assert finished.stderr.count("\n") == 1


def _finish(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [COMMAND, "lab", "--no-browser", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=DEADLINE)


def _run(connection_file: Path, code: str) -> str:
    """Run code in a kernel and return what it prints."""
    printed: list[str] = []

    def hear(message: dict[str, Any]) -> None:
        printed.append(message["content"].get("text", "") or str(message["content"].get("traceback", "")))

    client = BlockingKernelClient(connection_file=str(connection_file))
    client.load_connection_file()
    client.start_channels(hb=False)  # a kernel whose heart is slow, on a busy machine, counts as dead
    try:
        client.wait_for_ready(DEADLINE)
        client.execute_interactive(code, timeout=DEADLINE, output_hook=hear)
    finally:
        client.stop_channels()
    return "".join(printed)


def _tree(folder: Path) -> dict[str, tuple[int, str]]:
    """Return the time and the hash of every file below `folder`."""
    return {
        str(path): (path.stat().st_mtime_ns, hashlib.sha256(path.read_bytes()).hexdigest())
        for path in folder.rglob("*")
        if path.is_file()
    }
