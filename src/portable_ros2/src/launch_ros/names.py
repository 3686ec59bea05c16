"""Names of nodes and namespaces, and the rules that remap names."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from launch.utilities import normalize_to_list_of_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.substitution import Substitution

_TOKEN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class InvalidNodeNameException(ValueError):  # noqa: N818 -- as rclpy calls it
    """A text is no node name."""


class InvalidNamespaceException(ValueError):  # noqa: N818 -- as rclpy calls it
    """A text is no namespace."""


def is_root_namespace(ns: str) -> bool:
    """Return whether a namespace is the one that all others are in."""
    return ns == "/"


def is_namespace_absolute(ns: str) -> bool:
    """Return whether a namespace begins with a slash."""
    return ns.startswith("/")


def prefix_namespace(base_ns: str | None, ns: str | None) -> str | None:
    """Return a namespace below another one, unless it is absolute."""
    if ns is None:
        combined = base_ns
    elif not base_ns or is_namespace_absolute(ns):
        combined = ns
    else:
        combined = f"{base_ns.rstrip('/')}/{ns}"
    return combined if combined is None or is_root_namespace(combined) else combined.rstrip("/")


def make_namespace_absolute(ns: str | None) -> str | None:
    """Return a namespace with a slash before it."""
    return ns if ns is None or is_namespace_absolute(ns) else f"/{ns}"


def normalize_remap_rule(remap_rule: Any) -> tuple[tuple[Substitution, ...], tuple[Substitution, ...]]:
    """Return the substitutions that make the two names of a rule.

    Raises:
        TypeError: if it is no pair.
    """
    if not isinstance(remap_rule, tuple):
        raise TypeError(
            f"Expected 'remap_rule' to be a tuple, but got '{remap_rule}' of type '{type(remap_rule)}'"
        )
    if len(remap_rule) != 2:
        raise TypeError(f"remap_rule must be a tuple of length 2, got length {len(remap_rule)}")
    source, target = (tuple(normalize_to_list_of_substitutions(name)) for name in remap_rule)
    return source, target


def normalize_remap_rules(
    remap_rules: Iterable[Any],
) -> Iterator[tuple[tuple[Substitution, ...], tuple[Substitution, ...]]]:
    """Yield the substitutions that make the names of rules."""
    return (normalize_remap_rule(rule) for rule in remap_rules)


def add_node_name(context: LaunchContext, node_name: str) -> None:
    """Remember that there is one more node of this name."""
    names = context.get_locals_as_dict().get("unique_ros_node_names", {})
    context.extend_globals({"unique_ros_node_names": {**names, node_name: names.get(node_name, 0) + 1}})


def get_node_name_count(context: LaunchContext, node_name: str) -> int:
    """Return how many nodes of this name there are."""
    count: int = context.get_locals_as_dict().get("unique_ros_node_names", {}).get(node_name, 0)
    return count


def validate_node_name(name: str) -> None:
    """Raise InvalidNodeNameException if a text is no node name."""
    fault = _fault(name)
    if fault is not None:
        reason, at = fault
        raise InvalidNodeNameException(f"Invalid node name: node name must not {reason}:{_pointer(name, at)}")


def validate_namespace(namespace: str) -> None:
    """Raise InvalidNamespaceException if a text is no absolute namespace."""
    if namespace == "/":
        return
    start = 1
    for token in namespace[1:].split("/"):
        fault = _fault(token)
        if fault is not None:
            reason, at = fault
            reason = reason.replace("start with", "have a token that starts with")
            text = f"Invalid namespace: namespace must not {reason}:{_pointer(namespace, start + at)}"
            raise InvalidNamespaceException(text)
        start += len(token) + 1


def _fault(token: str) -> tuple[str, int] | None:
    """Return what a name must not do, and where it does."""
    if not token:
        return "be empty", 0
    if token[0].isdigit():
        return "start with a number", 0
    valid = _TOKEN.match(token)
    end = valid.end() if valid else 0
    return None if end == len(token) else ("contain characters other than alphanumerics or '_'", end)


def _pointer(text: str, at: int) -> str:
    return f"\n  '{text}'\n   {' ' * at}^"
