"""Nodes by name, as `ros2 node` and `ros2 param` look for them."""

from __future__ import annotations

import argparse
import time
from typing import Any, NamedTuple

from portable_ros2.graph import POLL_PERIOD, GraphNode

HIDDEN_PREFIX = "_"
COMPLETION_SPIN_TIME = 0.1  # s; a key was pressed, and somebody waits


class NodeName(NamedTuple):
    """A node's name in its parts, sorted as they stand here."""

    name: str
    namespace: str
    full_name: str


def parse(name: str) -> NodeName:
    """Return the parts of a name; one without a slash in front is taken from the root."""
    full_name = absolute(name)
    namespace, _, base = full_name.rpartition("/")
    return NodeName(base, namespace or "/", full_name)


def absolute(name: str) -> str:
    """Return a name with a slash in front, and an empty one as it is."""
    return name if not name or name.startswith("/") else f"/{name}"


def present(node: Any, include_hidden: bool = False) -> list[NodeName]:
    """Return the nodes of the graph; two of the same name twice."""
    return [
        NodeName(name, namespace, f"{namespace.rstrip('/')}/{name}")
        for name, namespace in node.get_node_names_and_namespaces()
        if include_hidden or (name and not name.startswith(HIDDEN_PREFIX))
    ]


def wait_for(node: Any, full_name: str, include_hidden: bool, timeout: float) -> bool:
    """Wait until a node is there; tell whether it is."""
    deadline = time.monotonic() + timeout
    while full_name not in {known.full_name for known in present(node, include_hidden)}:
        if time.monotonic() >= deadline:
            return False
        time.sleep(POLL_PERIOD)
    return True


def complete(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Return the names of the nodes that there are."""
    with GraphNode(argparse.Namespace(spin_time=COMPLETION_SPIN_TIME)) as node:
        hidden = getattr(parsed_args, "include_hidden_nodes", False)
        return sorted({known.full_name for known in present(node, hidden)})


def is_hidden(name: str) -> bool:
    """Return whether a part of a topic's, service's or action's name begins with an underscore."""
    return any(part.startswith(HIDDEN_PREFIX) for part in name.split("/"))
