"""`ros2 action`: the course's wheels have no action type; one that is kept for tests only has, in a folder of its own."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from running import Running

from portable_ros2.commands.action import _actions

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]
Worker = Callable[..., "subprocess.Popen[str]"]
LOCK = Path(__file__).parents[2] / "locks/actions.txt"
FIBONACCI = "test_msgs/action/Fibonacci"
FIBONACCIS = (0, 1, 1, 2, 3, 5, 8, 13)
ID = re.compile("[0-9a-f]{32}")


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder into which the locked wheel of `test_msgs` was installed, as an overlay is."""
    folder = tmp_path_factory.mktemp("actions")
    uv = str(Path(sys.executable).with_name("uv"))
    words = ["pip", "install", "--quiet", "--no-deps", "--require-hashes", "--requirement", str(LOCK)]
    subprocess.run([uv, *words, "--python", sys.executable, "--target", str(folder)], check=True)
    return folder


@pytest.fixture
def server(wheel: Path, worker: Worker, monkeypatch: pytest.MonkeyPatch) -> subprocess.Popen[str]:
    """Source the overlay, and start a real action server in it."""
    [packages] = wheel.glob("lib/python*/site-packages")
    for name, place in (
        ("PYTHONPATH", packages),
        ("LD_LIBRARY_PATH", wheel / "lib"),
        ("AMENT_PREFIX_PATH", wheel),
    ):
        monkeypatch.setenv(name, os.pathsep.join(filter(None, (str(place), os.environ.get(name)))))
    return worker(file="action_server.py")


def test_without_an_action_type_it_is_said_where_one_is(ros2: Ros2) -> None:
    result = ros2("action", "send_goal", "/fibonacci", "example_interfaces/action/Fibonacci", "{order: 3}")
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr == (
        "The action type 'example_interfaces/action/Fibonacci' cannot be used: no package with actions is "
        "installed here; the packages of ROS's wheels have messages and services only, and an installed ROS 2 "
        "brings actions, too (apt install ros-jazzy-example-interfaces).\n"
    )


@pytest.mark.thorough
def test_look_ups_where_there_is_no_action(ros2: Ros2) -> None:
    for words, code, output in (
        (("list",), 0, ""),
        (("list", "-c"), 0, "0\n"),
        (("type", "/nothing"), 1, ""),
        (("info", "nothing"), 0, "Action: nothing\nAction clients: 0\nAction servers: 0\n"),
    ):
        result = ros2("action", *words)
        assert (result.returncode, result.stdout, result.stderr) == (code, output, ""), words
    wrong = ros2("action", "info", "/a//b")
    assert wrong.returncode == 1
    assert wrong.stderr.startswith("Invalid topic name")


@pytest.mark.usefixtures("server")
def test_a_real_server_is_looked_up(ros2: Ros2) -> None:
    for words, output in (
        (("list",), "/fibonacci\n"),
        (("list", "-t"), f"/fibonacci [{FIBONACCI}]\n"),
        (("type", "/fibonacci"), f"{FIBONACCI}\n"),
        (("info", "/fibonacci"), "Action: /fibonacci\nAction clients: 0\nAction servers: 1\n    /counter\n"),
    ):
        result = ros2("action", *words)
        assert (result.returncode, result.stdout, result.stderr) == (0, output, ""), words


@pytest.mark.usefixtures("server")
def test_a_goal_is_sent_and_its_result_shown(ros2: Ros2) -> None:
    result = ros2("action", "send_goal", "/fibonacci", FIBONACCI, "{order: 3}")
    assert (result.returncode, result.stderr) == (0, "")
    assert ID.sub("ID", result.stdout) == (
        "Waiting for an action server to become available...\n"
        "Sending goal:\n     order: 3\n\n"
        "Goal accepted with ID: ID\n\n"
        "Result:\n    sequence:\n- 0\n- 1\n- 1\n- 2\n\n"
        "Goal finished with status: SUCCEEDED\n"
    )


@pytest.mark.usefixtures("server")
@pytest.mark.parametrize(
    ("order", "end"),
    [
        (11, "Goal was rejected."),
        pytest.param(-1, "Goal finished with status: ABORTED", marks=pytest.mark.thorough),
    ],
)
def test_a_server_may_not_want_to(ros2: Ros2, order: int, end: str) -> None:
    result = ros2("action", "send_goal", "--stdin", "/fibonacci", FIBONACCI, text=f"order: {order}")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.splitlines()[-1] == end


def test_ctrl_c_cancels_the_goal(server: subprocess.Popen[str], started: Callable[..., Running]) -> None:
    """As with the real one, what the server answers is shown; feedback may come before all else."""
    sending = started("action", "send_goal", "--feedback", "/fibonacci", FIBONACCI, "{order: 7}")
    sending.wait_for("Goal accepted")
    sending.wait_for("- 13")
    assert sending.end(signal.SIGINT) == 0
    numbers = ["".join(f"- {number}\n" for number in FIBONACCIS[:count]) for count in range(3, 9)]
    assert sending.errors == ""
    for sequence in numbers:
        assert f"Feedback:\n    sequence:\n{sequence}\n" in sending.output
    assert sending.output.partition("Canceling")[2] == (
        f" goal...\nGoal canceled.\nResult:\n    sequence:\n{numbers[-1]}\nGoal finished with status: CANCELED\n"
    )
    assert server.poll() is None


@pytest.mark.usefixtures("server")
def test_it_waits_no_longer_than_it_is_told(ros2: Ros2) -> None:
    """The goal goes on: as with the real one, only who waits has gone."""
    for name, order, end in (
        ("/fibonacci", 7, "Timed out waiting for result after 0 seconds."),
        ("/nobody", 1, "Action server is not available after waiting 0 seconds."),
    ):
        result = ros2("action", "send_goal", "-t", "0", name, FIBONACCI, f"order: {order}")
        assert (result.returncode, result.stderr, result.stdout.splitlines()[-1]) == (0, "", end)
    assert ros2("action", "send_goal", "-t", "-1", "/nobody", FIBONACCI).returncode == 2


@pytest.mark.usefixtures("server")
def test_a_wrong_goal_is_refused(ros2: Ros2) -> None:
    result = ros2("action", "send_goal", "/fibonacci", FIBONACCI, "{orders: 3}")
    assert (result.returncode, result.stdout) == (1, "")
    assert "orders" in result.stderr


def test_a_type_is_found_where_one_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_actions, "types", lambda: ["demo/action/Go"])
    with pytest.raises(RuntimeError, match=r"The passed action type is invalid.*'demo'"):
        _actions.find("demo/action/Go")
