"""`ros2 lifecycle`, as a student types it beside a node with states."""

from __future__ import annotations

import subprocess
from collections.abc import Callable

import pytest

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]
Worker = Callable[..., "subprocess.Popen[str]"]
NODE = "/ns/camera"


def test_a_node_is_found_and_changed(ros2: Ros2, worker: Worker) -> None:
    worker(file="lifecycle_worker.py")
    assert ros2("lifecycle", "nodes").stdout == f"{NODE}\n"
    result = ros2("lifecycle", "set", NODE, "configure")
    assert (result.returncode, result.stdout, result.stderr) == (0, "Transitioning successful\n", "")
    assert ros2("lifecycle", "get").stdout == f"{NODE}: inactive [2]\n"


@pytest.mark.thorough
def test_a_node_is_asked_and_changed_in_every_way(ros2: Ros2, worker: Worker) -> None:
    worker(file="lifecycle_worker.py")
    worker()  # has no states
    assert ros2("lifecycle", "nodes").stdout == f"{NODE}\n"
    assert ros2("lifecycle", "nodes", "-c").stdout == "1\n"
    assert ros2("lifecycle", "get").stdout == f"{NODE}: unconfigured [1]\n"
    listed = ros2("lifecycle", "list", NODE).stdout
    assert listed == (
        "- configure [1]\n\tStart: unconfigured\n\tGoal: configuring\n"
        "- shutdown [5]\n\tStart: unconfigured\n\tGoal: shuttingdown\n"
    )
    assert len(ros2("lifecycle", "list", "-a", NODE).stdout.splitlines()) > len(listed.splitlines())

    unknown = ros2("lifecycle", "set", NODE, "activate")
    text = "Unknown transition requested, available ones are:\n- configure [1]\n- shutdown [5]\n"
    assert (unknown.returncode, unknown.stdout, unknown.stderr) == (1, "", text)
    for transition in ("configure", "3", "deactivate"):
        result = ros2("lifecycle", "set", NODE.removeprefix("/"), transition)
        assert (result.returncode, result.stdout, result.stderr) == (0, "Transitioning successful\n", "")
    again = ros2("lifecycle", "set", NODE, "activate")
    assert (again.returncode, again.stdout, again.stderr) == (0, "", "Transitioning failed\n")
    assert ros2("lifecycle", "get", NODE).stdout == "inactive [2]\n"


@pytest.mark.thorough
def test_a_node_without_states_is_not_found(ros2: Ros2, worker: Worker) -> None:
    worker()
    for words in (("get", "/ns/worker"), ("list", "/nowhere"), ("set", "/nowhere", "configure")):
        result = ros2("lifecycle", *words)
        assert (result.returncode, result.stdout, result.stderr) == (1, "", "Node not found\n"), words
    assert ros2("lifecycle", "nodes").stdout == ""
    assert ros2("lifecycle", "get").stdout == ""


@pytest.mark.thorough
def test_a_node_that_does_not_answer_is_told(ros2: Ros2, worker: Worker) -> None:
    worker("silent", file="lifecycle_worker.py")
    text = f"Exception while calling service of node '{NODE}': there was no answer for 5 seconds\n"
    result = ros2("lifecycle", "get", NODE)
    assert (result.returncode, result.stdout, result.stderr) == (1, "", text)
