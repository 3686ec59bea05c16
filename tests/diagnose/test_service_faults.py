"""Services and actions with other names at the client than at the server."""

from __future__ import annotations

import pytest

from ros2lab.diagnose.nodes.service_faults import service_faults
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource

HEAD = """\
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from std_srvs.srv import Empty, Trigger


class Demo(Node):
    def __init__(self):
        super().__init__({node})
        self.end = {end}
"""


def fixes(server: str, client: str, nodes: tuple[str, str] = ("'a'", "'b'"), own: str = "pk") -> list[str]:
    texts = {"pk.a": HEAD.format(node=nodes[0], end=server), "pk.b": HEAD.format(node=nodes[1], end=client)}
    files = NodeSources({name: PythonSource(name, f"{name}.py", text) for name, text in texts.items()})
    return [finding.fix for finding in service_faults([files], {own}, ())]


def server_of(name: str, kind: str = "Trigger") -> str:
    return f"self.create_service({kind}, {name!r}, self.go)"


@pytest.mark.parametrize(
    ("server", "client", "nodes"),
    [
        ("/door/open", "open_door", ("'a'", "'b'")),
        ("start", "start", ("'a', namespace='hall'", "'b'")),
        ("~/start", "start", ("'a'", "'b'")),
        ("~/start", "~/start", ("'a'", "'b'")),
        ("/wash/start", "startWash", ("'a'", "'b'")),
        ("open_gate", "open_gat", ("'a'", "'b'")),
    ],
)
def test_two_names_of_the_same_words_are_told_with_the_call_to_write(
    server: str, client: str, nodes: tuple[str, str]
) -> None:
    (fix,) = fixes(server_of(server), f"self.create_client(Trigger, {client!r})", nodes)
    name = {"start": "/hall/start", "~/start": "/a/start"}.get(server, f"/{server.lstrip('/')}")
    assert fix.startswith(f"write `self.create_client(Trigger, '{name}')` here")


def test_an_action_is_told_as_well() -> None:
    server = "ActionServer(self, Fibonacci, '/fib/count', self.go)"
    (fix,) = fixes(server, "ActionClient(self, Fibonacci, 'count_fib')")
    assert fix.startswith("write `ActionClient(self, Fibonacci, '/fib/count')` here")


def test_a_type_of_the_workspace_is_enough() -> None:
    (fix,) = fixes(server_of("wash"), "self.create_client(Trigger, 'begin')", own="std_srvs")
    assert "'/wash'" in fix


@pytest.mark.parametrize(
    ("server", "client", "nodes"),
    [
        (server_of("/hall/start"), "self.create_client(Trigger, 'start')", ("'a'", "'b', namespace='hall'")),
        (server_of("~/start"), "self.create_client(Trigger, 'a/start')", ("'a'", "'b'")),
        (server_of("reset_counter", "Empty"), "self.create_client(Empty, '/reset')", ("'a'", "'b'")),
        (server_of("/robot/start"), "self.create_client(Trigger, '/robot/reset')", ("'a'", "'b'")),
        (server_of("/door/open", "Empty"), "self.create_client(Trigger, 'open_door')", ("'a'", "'b'")),
        (server_of("wash"), "self.create_client(Trigger, 'begin')", ("'a'", "'b'")),
    ],
)
def test_right_names_and_services_of_others_are_not_told(
    server: str, client: str, nodes: tuple[str, str]
) -> None:
    assert not fixes(server, client, nodes)
