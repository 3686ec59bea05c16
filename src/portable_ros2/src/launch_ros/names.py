"""Names of nodes and namespaces."""

from __future__ import annotations

import re

_TOKEN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class InvalidNodeNameException(ValueError):  # noqa: N818 -- as rclpy calls it
    """A text is no node name."""


class InvalidNamespaceException(ValueError):  # noqa: N818 -- as rclpy calls it
    """A text is no namespace."""


def prefix_namespace(base: str | None, namespace: str | None) -> str | None:
    """Return a namespace below another one, unless it is absolute."""
    if namespace is None:
        combined = base
    elif not base or namespace.startswith("/"):
        combined = namespace
    else:
        combined = f"{base.rstrip('/')}/{namespace}"
    return combined if combined in (None, "/") else str(combined).rstrip("/")


def make_namespace_absolute(namespace: str | None) -> str | None:
    """Return a namespace with a slash before it."""
    return namespace if namespace is None or namespace.startswith("/") else f"/{namespace}"


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
