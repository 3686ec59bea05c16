"""Matchers of nodes; the events of launch_ros itself are about lifecycle nodes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from launch.lookup import lookup

if TYPE_CHECKING:
    from launch_ros.actions import Node

__getattr__ = lookup(__name__)


def matches_node_name(node_name: str) -> Callable[[Node], bool]:
    """Return a function that tells whether a node has a name."""
    name = node_name if node_name.startswith("/") else f"/{node_name}"
    return lambda action: action.node_name == name


__all__ = ["matches_node_name"]
