"""Services and their types, as the verbs of `ros2 service` look for them."""

from __future__ import annotations

import argparse
import re
from typing import Any

from portable_ros2 import ament_index, messages
from portable_ros2.commands.node._nodes import COMPLETION_SPIN_TIME, is_hidden
from portable_ros2.graph import GraphNode

NamesAndTypes = list[tuple[str, list[str]]]


def names_and_types(node: Any, include_hidden: bool) -> NamesAndTypes:
    """Return the services with their types; a part of a hidden one's name begins with an underscore."""
    found: NamesAndTypes = node.get_service_names_and_types()
    return [(name, types) for name, types in found if include_hidden or not is_hidden(name)]


def add_hidden_argument(parser: argparse.ArgumentParser) -> None:
    """Add the option that may also stand before the verb, where it must not be forgotten."""
    parser.add_argument(
        "--include-hidden-services",
        action="store_true",
        default=argparse.SUPPRESS,
        help="Consider hidden services as well",
    )


def add_service_argument(parser: argparse.ArgumentParser, purpose: str) -> None:
    """Add the name of a service, which completes."""
    name = parser.add_argument("service_name", help=f"Name of the ROS service to {purpose}")
    name.completer = complete_service  # type: ignore[attr-defined]


def complete_service(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Return the names of the services that there are."""
    with GraphNode(argparse.Namespace(spin_time=COMPLETION_SPIN_TIME)) as node:
        hidden = getattr(parsed_args, "include_hidden_services", False)
        return [name for name, _ in names_and_types(node, hidden)]


def complete_type(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Return the types of the service that was already named, or all that there are."""
    service = getattr(parsed_args, "service_name", None)
    if service:
        with GraphNode(argparse.Namespace(spin_time=COMPLETION_SPIN_TIME)) as node:
            for name, types in names_and_types(node, include_hidden=True):
                if name == service:
                    return types
    return service_types()


def complete_values(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Return a request of the type that was already named, with the fields' default values."""
    try:
        return [messages.to_yaml(messages.find_service(parsed_args.service_type).Request())]
    except RuntimeError:
        return []


def service_types() -> list[str]:
    """Return the names of all service types that are installed, as `std_srvs/srv/Trigger`."""
    return sorted(
        f"{package}/{match[1]}"
        for package in ament_index.resources(messages.INTERFACES)
        for match in re.finditer(
            r"^(srv/\w+)\.srv\s*$", ament_index.resource(messages.INTERFACES, package) or "", re.MULTILINE
        )
    )
