"""Actions and their types, as the verbs of `ros2 action` look for them."""

from __future__ import annotations

import argparse
from typing import Any

from portable_ros2 import interfaces, messages
from portable_ros2.commands.node._nodes import COMPLETION_SPIN_TIME
from portable_ros2.graph import GraphNode

NamesAndTypes = list[tuple[str, list[str]]]


def names_and_types(node: Any) -> NamesAndTypes:
    """Return the actions with their types."""
    from rclpy.action import get_action_names_and_types

    found: NamesAndTypes = get_action_names_and_types(node.node)
    return found


def add_action_argument(parser: argparse.ArgumentParser, purpose: str) -> None:
    """Add the name of an action, which completes."""
    name = parser.add_argument("action_name", help=f"Name of the ROS action{purpose} (e.g. '/fibonacci')")
    name.completer = _complete_action  # type: ignore[attr-defined]


def types() -> list[str]:
    """Return the names of all action types that are installed, as `pkg/action/Name`."""
    return [
        f"{package}/{name}"
        for package in interfaces.packages()
        for name in interfaces.of_package(package, ("action",))
    ]


def find(name: str) -> type[Any]:
    """Return the class of an action type.

    Raises:
        RuntimeError: if there is none of this name, or none at all.
    """
    if not types():
        raise RuntimeError(
            f"The action type '{name}' cannot be used: no package with actions is installed here; the packages "
            "of ROS's wheels have messages and services only, and an installed ROS 2 brings actions, too "
            "(apt install ros-jazzy-example-interfaces)."
        )
    return messages.find_action(name)


def complete_type(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Return the types of the action that was already named, or all that there are."""
    with GraphNode(argparse.Namespace(spin_time=COMPLETION_SPIN_TIME)) as node:
        return dict(names_and_types(node)).get(parsed_args.action_name) or types()


def complete_goal(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Return a goal of the type that was already named, with the fields' default values."""
    try:
        return [messages.to_yaml(find(parsed_args.action_type).Goal())]
    except RuntimeError:
        return []


def _complete_action(**_: Any) -> list[str]:
    with GraphNode(argparse.Namespace(spin_time=COMPLETION_SPIN_TIME)) as node:
        return [name for name, _types in names_and_types(node)]
