"""`ros2 action`: the wheels have no action type, so that a server cannot run beside it."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from action_msgs.msg import GoalInfo, GoalStatus
from rclpy.task import Future
from std_msgs.msg import String

from portable_ros2.commands.action import _actions, send_goal

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]


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


class Client:
    """In place of rclpy's ActionClient, which needs an action type in C."""

    def __init__(self, *, accepted: bool = True, interrupted: bool = False) -> None:
        self.accepted, self.interrupted = accepted, interrupted
        self.goal_id = GoalInfo().goal_id

    def wait_for_server(self) -> None:
        """Be there."""

    def send_goal_async(self, goal: Any, on_feedback: Any) -> Any:
        """Take a goal."""
        if on_feedback is not None:
            on_feedback(SimpleNamespace(feedback=String(data=f"on {goal.data}")))
        return done(self)

    def get_result_async(self) -> Any:
        """Return the result, unless somebody presses Ctrl-C."""
        if self.interrupted:
            raise KeyboardInterrupt
        return done(SimpleNamespace(result=String(data="there"), status=GoalStatus.STATUS_SUCCEEDED))

    def cancel_goal_async(self) -> Any:
        """Give the goal up."""
        return done(SimpleNamespace(goals_canceling=[GoalInfo()]))


def done(result: Any) -> Any:
    future = Future()
    future.set_result(result)
    return future


@pytest.fixture
def node(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr("rclpy.spin_until_future_complete", lambda *_: None)
    return SimpleNamespace(node=None)


def test_a_goal_is_sent_and_its_result_shown(node: Any, capsys: pytest.CaptureFixture[str]) -> None:
    send_goal._send(node, Client(), String(data="way"), send_goal._show_feedback)
    assert capsys.readouterr().out == (
        "Waiting for an action server to become available...\n"
        "Sending goal:\n     data: way\n\n"
        "Feedback:\n    data: on way\n\n"
        f"Goal accepted with ID: {'0' * 32}\n\n"
        "Result:\n    data: there\n\n"
        "Goal finished with status: SUCCEEDED\n"
    )


def test_a_goal_may_be_rejected_or_canceled(node: Any, capsys: pytest.CaptureFixture[str]) -> None:
    send_goal._send(node, Client(accepted=False), String(), None)
    assert capsys.readouterr().out.endswith("Goal was rejected.\n")
    with pytest.raises(KeyboardInterrupt):
        send_goal._send(node, Client(interrupted=True), String(), None)
    assert capsys.readouterr().out.endswith("Canceling goal...\nGoal canceled.\n")


def test_a_type_is_found_where_one_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_actions, "types", lambda: ["demo/action/Go"])
    with pytest.raises(RuntimeError, match=r"The passed action type is invalid.*'demo'"):
        _actions.find("demo/action/Go")
