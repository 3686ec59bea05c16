"""What `ros2lab dashboard` decides before there is a server."""

from __future__ import annotations

import os
import re
import socket
from collections.abc import Iterator, MutableMapping
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from ros2lab import cli, environment, jupyter_settings
from ros2lab.verbs import dashboard, lab


@pytest.fixture
def environ() -> Iterator[MutableMapping[str, str]]:
    """Give the environment, which the test may empty, back as it was."""
    before = dict(os.environ)
    yield os.environ
    os.environ.clear()
    os.environ.update(before)


def test_a_page_is_not_one_of_the_students_notebooks(
    environ: MutableMapping[str, str], tmp_path: Path
) -> None:
    """So that `session.stop_others()` in a notebook leaves it alone; and its Jupyter is its own."""
    environ.update({"ROS2LAB_WORK": "/home/x/work", "JUPYTER_TOKEN": "1234", "JUPYTER_PATH": "/else"})
    dashboard.enter(tmp_path, None)
    assert "ROS2LAB_WORK" not in environ
    assert "JUPYTER_TOKEN" not in environ
    folders = [environ[f"JUPYTER_{name}_DIR"] for name in ("CONFIG", "DATA", "RUNTIME")]
    assert all(Path(folder).is_relative_to(tmp_path) for folder in folders)
    template = Path(environ["JUPYTER_PATH"], "nbconvert/templates/ros2lab/index.html.j2")
    assert template.is_file()


@pytest.mark.parametrize(("option", "domain"), [(None, "31"), (0, "0"), (17, "17")])
def test_the_option_beats_the_variable(
    environ: MutableMapping[str, str], tmp_path: Path, option: int | None, domain: str
) -> None:
    environ["ROS_DOMAIN_ID"] = "31"
    dashboard.enter(tmp_path, option)
    assert environ["ROS_DOMAIN_ID"] == domain


def test_without_ros_it_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    missing = environment.RosSource("missing", None, False, "")
    monkeypatch.setattr(environment, "find_ros", lambda: missing)
    result = CliRunner().invoke(cli.app, ["dashboard", "--no-browser"])
    assert result.exit_code == 1
    assert result.output == "There is no ROS 2 for this Python: `ros2lab doctor` tells more.\n"


def test_a_named_port_in_use_is_one_sentence_with_one_that_is_free() -> None:
    with socket.socket() as taken:
        taken.bind((jupyter_settings.HOST, 0))
        taken.listen()
        port = taken.getsockname()[1]
        result = CliRunner().invoke(cli.app, ["dashboard", "--no-browser", "--port", str(port)])
    assert result.exit_code == 1
    wanted = rf"Port {port} is used by another program: run `ros2lab dashboard --port \d+`\.\n"
    assert re.fullmatch(wanted, result.output)


def test_the_first_free_port_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lab, "_port_problem", lambda port: int(port < 8869))
    assert lab.free_port(dashboard.FIRST_PORT) == 8869


@pytest.mark.parametrize("domain", ["-1", "233", "robot"])
def test_a_domain_that_is_none_is_refused(domain: str) -> None:
    result = CliRunner().invoke(cli.app, ["dashboard", "--no-browser", "--domain", domain])
    assert result.exit_code == 2
    assert "--domain" in result.output


def test_a_page_that_cannot_be_opened_says_why(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In one sentence, and not with what a kernel shows."""
    from ros2lab.page import kernel

    shown: list[Any] = []
    monkeypatch.setattr(kernel, "display", lambda data, **_: shown.append(data.data))
    monkeypatch.setenv("ROS_DOMAIN_ID", "<robot>")
    assert kernel.show() is None
    assert len(shown) == 1
    assert "The dashboard cannot be opened: The domain id must be a whole number" in shown[0]
    assert "&lt;robot&gt;" in shown[0]
    assert capsys.readouterr().out == ""
