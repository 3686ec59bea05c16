"""`ros2 node`, as a student types it beside a running node."""

from __future__ import annotations

import argparse
import subprocess
from collections.abc import Callable
from typing import Any

import pytest

from portable_ros2.commands.node import _nodes

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]
Worker = Callable[..., "subprocess.Popen[str]"]
DUPLICATES = (
    "WARNING: Be aware that there are nodes in the graph that share an exact name, "
    "which can have unintended side effects.\n"
)


class FakeNode:
    """Answers as a node that looks at the graph does."""

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return [("b", "/"), ("a", "/ns"), ("_hidden", "/"), ("b", "/")]


class TestNames:
    """Names of nodes in their parts."""

    @pytest.mark.parametrize(
        ("text", "parts"),
        [
            ("/a", ("a", "/", "/a")),
            ("a", ("a", "/", "/a")),
            ("/ns/deep/a", ("a", "/ns/deep", "/ns/deep/a")),
            ("ns/a", ("a", "/ns", "/ns/a")),
        ],
    )
    def test_parse(self, text: str, parts: tuple[str, ...]) -> None:
        assert _nodes.parse(text) == parts

    def test_hidden_ones_are_shown_on_demand(self) -> None:
        node: Any = FakeNode()
        assert [name.full_name for name in _nodes.present(node)] == ["/b", "/ns/a", "/b"]
        assert "/_hidden" in [name.full_name for name in _nodes.present(node, include_hidden=True)]

    @pytest.mark.parametrize(
        ("name", "is_hidden"),
        [("/a", False), ("/_a", True), ("/a/_b/c", True), ("/a_b", False), ("/a/b_", False)],
    )
    def test_is_hidden(self, name: str, is_hidden: bool) -> None:
        assert _nodes.is_hidden(name) is is_hidden

    def test_a_missing_one_is_not_waited_for_longer_than_said(self) -> None:
        node: Any = FakeNode()
        assert _nodes.wait_for(node, "/ns/a", include_hidden=False, timeout=0)
        assert not _nodes.wait_for(node, "/nobody", include_hidden=True, timeout=0)


class TestList:
    """`ros2 node list`."""

    def test_shows_names_in_order(self, ros2: Ros2, worker: Worker) -> None:
        worker()
        worker("--ros-args", "-r", "__ns:=/", "-r", "__node:=zebra")
        result = ros2("node", "list")
        assert (result.returncode, result.stdout, result.stderr) == (0, "/ns/worker\n/zebra\n", "")
        assert ros2("node", "list", "-c").stdout == "2\n"
        lines = ros2("node", "list", "--all").stdout.splitlines()
        assert [line for line in lines if line.startswith("/_ros2cli_")]
        assert len(lines) == 3

    def test_warns_of_equal_names(self, ros2: Ros2, worker: Worker) -> None:
        worker()
        worker()
        result = ros2("node", "list")
        assert (result.returncode, result.stdout, result.stderr) == (0, "/ns/worker\n" * 2, DUPLICATES)
        result = ros2("node", "info", "/ns/worker")
        assert result.returncode == 0
        assert result.stderr == (
            'There are 2 nodes in the graph with the exact name "/ns/worker". '
            "You are seeing information about only one of them.\n"
        )

    def test_nobody_is_there(self, ros2: Ros2) -> None:
        result = ros2("node", "list")
        assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
        assert ros2("node", "list", "--count-nodes").stdout == "0\n"


class TestInfo:
    """`ros2 node info`."""

    def test_shows_what_a_node_has(self, ros2: Ros2, worker: Worker) -> None:
        worker()
        result = ros2("node", "info", "/ns/worker")
        assert (result.returncode, result.stderr) == (0, "")
        services = "\n".join(
            f"    /ns/worker/{name}: {kind}"
            for name, kind in [
                ("describe_parameters", "rcl_interfaces/srv/DescribeParameters"),
                ("get_parameter_types", "rcl_interfaces/srv/GetParameterTypes"),
                ("get_parameters", "rcl_interfaces/srv/GetParameters"),
                ("get_type_description", "type_description_interfaces/srv/GetTypeDescription"),
                ("list_parameters", "rcl_interfaces/srv/ListParameters"),
                ("set_parameters", "rcl_interfaces/srv/SetParameters"),
                ("set_parameters_atomically", "rcl_interfaces/srv/SetParametersAtomically"),
            ]
        )
        assert result.stdout == (
            "/ns/worker\n"
            "  Subscribers:\n"
            "    /heard: std_msgs/msg/String\n"
            "  Publishers:\n"
            "    /ns/said: std_msgs/msg/String\n"
            "    /parameter_events: rcl_interfaces/msg/ParameterEvent\n"
            "    /rosout: rcl_interfaces/msg/Log\n"
            "  Service Servers:\n"
            "    /ns/die: std_srvs/srv/Trigger\n"
            "    /ns/switch: std_srvs/srv/SetBool\n"
            f"{services}\n"
            "  Service Clients:\n"
            "    /elsewhere: std_srvs/srv/Trigger\n"
            "  Action Servers:\n"
            "\n"
            "  Action Clients:\n"
            "\n"
        )
        hidden = ros2("node", "info", "--include-hidden", "/ns/worker").stdout
        assert "    /ns/_hidden: std_msgs/msg/String\n" in hidden
        assert "    /ns/_secret: std_srvs/srv/Trigger\n" in hidden

    @pytest.mark.parametrize("name", ["/nobody", "worker", "/", ""])
    def test_tells_that_there_is_no_such_node(self, name: str, ros2: Ros2) -> None:
        result = ros2("node", "info", name)
        assert (result.returncode, result.stdout) == (1, "")
        assert result.stderr == f"Unable to find node '{name}'\n"

    def test_needs_a_name(self, ros2: Ros2) -> None:
        result = ros2("node", "info")
        assert result.returncode == 2
        assert "the following arguments are required: node_name" in result.stderr


def test_names_complete(worker: Worker) -> None:
    """The names that complete are those that `list` shows."""
    worker()
    worker()
    # A key was pressed: a look that is not complete within its short time is tried again.
    while (found := _nodes.complete(argparse.Namespace())) == []:
        pass
    assert found == ["/ns/worker"]
