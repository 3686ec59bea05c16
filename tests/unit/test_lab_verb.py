"""What `ros2lab lab` decides before there is a server, and the command around it."""

from __future__ import annotations

import errno
import json
import logging
import socket
import stat
import subprocess
import sys
import webbrowser
from pathlib import Path

import pytest
from tornado.websocket import WebSocketClosedError
from typer.testing import CliRunner

from ros2lab import __version__, cli, jupyter_settings
from ros2lab.verbs import lab


@pytest.mark.parametrize(
    ("environ", "browser", "has_browser"),
    [
        ({"DISPLAY": ":0"}, "firefox", True),
        ({"WAYLAND_DISPLAY": "wayland-0"}, "xdg-open", True),
        ({"BROWSER": "/opt/editor/open"}, "/opt/editor/open", True),
        ({}, "firefox", False),
        ({"DISPLAY": ""}, "firefox", False),
        ({"DISPLAY": ":0"}, "w3m", False),
        ({"DISPLAY": ":0"}, "/usr/bin/lynx", False),
        ({"DISPLAY": ":0"}, None, False),
    ],
)
def test_a_browser_is_opened_only_on_a_screen(
    monkeypatch: pytest.MonkeyPatch, environ: dict[str, str], browser: str | None, has_browser: bool
) -> None:
    def get() -> webbrowser.BaseBrowser:
        if browser is None:
            raise webbrowser.Error
        return webbrowser.GenericBrowser(browser)

    monkeypatch.setattr(webbrowser, "get", get)
    assert lab.has_browser(environ) == has_browser


def test_jupyter_sees_nothing_of_the_users_own(tmp_path: Path) -> None:
    jupyter_settings.runtime_folder(tmp_path).mkdir(mode=0o700, parents=True)
    theirs = {"JUPYTER_TOKEN": "1234", "JUPYTERLAB_SETTINGS_DIR": "/else", "HOME": "/home/x"}
    variables = jupyter_settings.jupyter_variables(tmp_path, theirs)
    assert "JUPYTER_TOKEN" not in variables
    assert "JUPYTERLAB_SETTINGS_DIR" not in variables
    assert "JUPYTER_ALLOW_INSECURE_WRITES" not in variables
    assert variables["HOME"] == "/home/x"
    folders = [variables[f"JUPYTER_{name}_DIR"] for name in ("CONFIG", "DATA", "RUNTIME")]
    assert all(Path(folder).is_relative_to(tmp_path) for folder in folders)


@pytest.mark.parametrize(
    ("there", "kept"),
    [
        ({}, {}),
        ({"theme": "dark"}, {"theme": "dark"}),
        (
            {"disabledExtensions": {"@jupyter/nbgrader": False, "theirs": True}},
            {"@jupyter/nbgrader": False, "theirs": True},
        ),
        ({"disabledExtensions": ["theirs"]}, {"disabledExtensions": ["theirs"]}),
        (["no", "settings"], {}),
        ("{broken", {}),
    ],
)
def test_what_was_chosen_in_jupyter_is_kept(tmp_path: Path, there: object, kept: dict[str, object]) -> None:
    page_config = tmp_path / ".jupyter/config/labconfig/page_config.json"
    page_config.parent.mkdir(parents=True)
    page_config.write_text(there if isinstance(there, str) else json.dumps(there))
    jupyter_settings.make_jupyter_folders(tmp_path)
    first = page_config.read_bytes()
    settings = json.loads(first)
    disabled = settings["disabledExtensions"]
    assert kept.items() <= (settings | (disabled if isinstance(disabled, dict) else {})).items()
    assert isinstance(disabled, list) or "@jupyter-notebook/lab-extension" in disabled
    jupyter_settings.make_jupyter_folders(tmp_path)
    assert page_config.read_bytes() == first


def test_a_disk_without_permissions_is_allowed(tmp_path: Path) -> None:
    runtime = jupyter_settings.runtime_folder(tmp_path)
    runtime.mkdir(parents=True)
    runtime.chmod(runtime.stat().st_mode | stat.S_IROTH)
    assert jupyter_settings.jupyter_variables(tmp_path, {})["JUPYTER_ALLOW_INSECURE_WRITES"] == "1"


def test_a_browsers_command_line_shows_no_token(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Other users can read it; the page that it names is for this one only."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    for _ in range(2):
        lab.open_in_browser("lab", "http://127.0.0.1:8888/lab?a=b&token=secret")
    page = Path(opened[-1].removeprefix("file://"))
    assert "secret" not in opened[-1]
    assert "token=secret" in page.read_text()
    assert stat.S_IMODE(page.stat().st_mode) == 0o600


def test_a_port_in_use_gets_a_sentence_with_one_that_is_free() -> None:
    with socket.socket() as taken:
        taken.bind((jupyter_settings.HOST, 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(lab.LabError, match=rf"Port {port} is used .* `make lab PORT=(\d+)`") as caught:
            lab.check_port(port)
        lab.check_port(int(str(caught.value).split("=")[1].rstrip("`.")))


def test_the_port_that_is_named_is_the_next_free_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lab, "_port_problem", lambda port: errno.EADDRINUSE if port < 8890 else 0)
    with pytest.raises(lab.LabError, match="PORT=8890`"):
        lab.check_port(8888)


def test_a_port_that_is_not_allowed_gets_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lab, "_port_problem", lambda _port: errno.EACCES)
    with pytest.raises(lab.LabError, match="Port 80 cannot be used"):
        lab.check_port(80)


@pytest.mark.parametrize("words", ["--help", "doctor --help", "class grade --help"])
def test_help_waits_for_nothing_heavy_and_a_verb_not_for_the_others(words: str) -> None:
    code = "import atexit, sys; atexit.register(lambda: print(*sys.modules)); from ros2lab.cli import main; main()"
    command = [sys.executable, "-c", code, *words.split()]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert "Usage" in said
    loaded = set(said.splitlines()[-1].split())
    assert not {"rclpy", "jupyter_server", "jupyterlab", "matplotlib", "numpy"} & loaded
    assert ("ros2lab.verbs.lab" in loaded) == words.startswith("-")


def test_the_command_tells_its_verbs_and_its_version() -> None:
    runner = CliRunner()
    assert "lab" in runner.invoke(cli.app, ["--help"]).output
    assert runner.invoke(cli.app, ["--version"]).output == f"ros2lab {__version__}\n"


def test_a_page_that_has_gone_is_no_error_of_the_lab(caplog: pytest.LogCaptureFixture) -> None:
    """Any other error is told."""
    caplog.handler.addFilter(lab._is_worth_telling)
    for error in (WebSocketClosedError(), ValueError()):
        try:
            raise error
        except type(error):
            logging.getLogger("asyncio").exception("in a callback")
    assert [type(record.exc_info[1]) for record in caplog.records if record.exc_info] == [ValueError]
