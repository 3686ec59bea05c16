"""The `ros2` command as a student types it: a process of its own."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from running import Running

import launch.logging
from deadlines import DEADLINE
from launch import LaunchDescription, LaunchService
from warm import WarmCommand

Ros2 = Callable[..., subprocess.CompletedProcess[str]]
Worker = Callable[..., subprocess.Popen[str]]
Launched = Callable[..., tuple[int, list[str]]]


@pytest.fixture(scope="session")
def warm_ros2() -> Iterator[WarmCommand]:
    """The command with all of its verbs, and the messages that tests use, imported once."""
    ros = ("rclpy.node", "rclpy.executors", "rclpy.parameter_client")
    messages = ("std_msgs.msg", "geometry_msgs.msg", "rcl_interfaces.srv", "std_srvs.srv")
    ros2 = str(Path(sysconfig.get_path("scripts"), "ros2"))
    command = WarmCommand([ros2], "portable_ros2.command:main", "portable_ros2.commands", *ros, *messages)
    yield command
    command.close()


@pytest.fixture
def ros2(warm_ros2: WarmCommand, tmp_path: Path) -> Ros2:
    """Return a function that runs `ros2` with the given words, in the test's own folder."""

    def run(
        *words: str, cwd: Path = tmp_path, text: str = "", **variables: str
    ) -> subprocess.CompletedProcess[str]:
        environ = {**os.environ, **variables}
        return warm_ros2.run(*words, cwd=cwd, environ=environ, text=text, timeout=DEADLINE)

    return run


@pytest.fixture
def clean_launch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Give the test log files of its own, and the environment back that launch files change."""
    before = dict(os.environ)
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "log"))
    launch.logging.reset()
    yield
    launch.logging.reset()
    os.environ.clear()
    os.environ.update(before)


@pytest.fixture
def launched(capsys: pytest.CaptureFixture[str]) -> Launched:
    """Return a function that launches entities; it returns the exit code and the lines after the first two.

    Numbers of processes are N.
    """

    def run(*entities: Any, noninteractive: bool = True) -> tuple[int, list[str]]:
        service = LaunchService(noninteractive=noninteractive)
        service.include_launch_description(LaunchDescription(entities))
        code = service.run()
        text = re.sub(r"pid \[?\d+", "pid N", re.sub(r"(\w)-\d+\]", r"\1]", capsys.readouterr().out))
        first, second, *lines = text.splitlines()
        assert first.startswith("[INFO] [launch]: All log files can be found below ")
        assert second == "[INFO] [launch]: Default logging verbosity is set to INFO"
        return code, lines

    return run


@pytest.fixture
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Install a package `demo` with an executable `show` that shows its arguments and parameter files."""
    folder = tmp_path / "install"
    for part in ("share/ament_index/resource_index/packages", "share/demo/config", "lib/demo"):
        (folder / part).mkdir(parents=True)
    (folder / "share/ament_index/resource_index/packages/demo").touch()
    (folder / "share/demo/config/demo.yaml").write_text("/**:\n  ros__parameters:\n    k: 1\n")
    show = folder / "lib/demo/show"
    show.write_text(
        '#!/bin/bash\nfor word in "$@"; do echo "$word"; [ -f "$word" ] && cat "$word"; done; true\n'
    )
    show.chmod(0o755)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(folder))
    return folder


@pytest.fixture
def worker() -> Iterator[Worker]:
    """Return a function that starts the node of `worker.py`, or of another file, and waits until it is there."""
    started: list[subprocess.Popen[str]] = []

    def start(*words: str, file: str = "worker.py") -> subprocess.Popen[str]:
        program = [sys.executable, str(Path(__file__).with_name(file)), *words]
        process = subprocess.Popen(program, stdout=subprocess.PIPE, text=True)
        started.append(process)
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        return process

    yield start
    for process in started:
        process.send_signal(signal.SIGCONT)
        process.kill()
        process.communicate()


@pytest.fixture
def node(domain_id: int) -> Iterator[Node]:
    context = Context()
    context.init(domain_id=domain_id)
    node = rclpy.create_node("talker", namespace="/ns", context=context, start_parameter_services=False)
    yield node
    node.destroy_node()
    context.try_shutdown()


@pytest.fixture
def started(tmp_path: Path) -> Iterator[Callable[..., Running]]:
    """Return a function that starts a command in the background; what still runs at the end is ended."""
    running: list[Running] = []

    def start(*words: str) -> Running:
        folder = tmp_path / str(len(running))
        folder.mkdir()
        running.append(Running(folder, *words))
        return running[-1]

    yield start
    for one in running:
        if one.process.poll() is None:
            one.end()  # a killed one would leave files in shared memory
