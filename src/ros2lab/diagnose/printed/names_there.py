"""The names in a workspace that may be meant by a word in a terminal."""

from __future__ import annotations

from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.parameter_faults import declared_in
from ros2lab.diagnose.nodes.service_faults import ServiceEnd, service_ends
from ros2lab.diagnose.nodes.topic_faults import End, ends_of


def topic_ends(look: Look) -> list[End]:
    """Return the publishers and subscriptions of all packages."""
    return [end for package in look.packages for end in ends_of(look.sources(package))]


def all_service_ends(look: Look) -> list[ServiceEnd]:
    """Return the servers and clients of all packages, of services and of actions."""
    return [end for package in look.packages for end in service_ends(look.sources(package))]


def node_names(look: Look) -> list[str]:
    """Return the names of the nodes of all packages, with a slash before each."""
    return [f"/{name}" for package in look.packages for name in look.sources(package).node_names if name]


def declared_parameters(look: Look) -> dict[str, object]:
    """Return the parameters that the nodes of all packages declare, with their defaults."""
    found: dict[str, object] = {}
    for package in look.packages:
        found |= declared_in(look.sources(package)) or {}
    return found
