"""Publishers and subscriptions as they are written with another quality of service."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from ros2lab.diagnose.sources.syntax_parts import with_arguments

if TYPE_CHECKING:
    from ros2lab.diagnose.nodes.topic_faults import End

_CLASSES = {"durability": "DurabilityPolicy", "reliability": "ReliabilityPolicy"}


def with_policy(end: End, policy: str, value: str) -> str:
    """Return what to write so that an end has a policy, such as `durability` TRANSIENT_LOCAL."""
    source, given = end.creation.source, end.creation.given("qos_profile")
    added = f"{policy}={_CLASSES[policy]}.{value}"
    written = source.written(given)
    if isinstance(written, ast.Call) and policy not in {keyword.arg for keyword in written.keywords}:
        profile = f"{ast.unparse(written).removesuffix(')')}, {added})"
    else:
        depth = end.sources.value(source, given)
        profile = f"QoSProfile(depth={depth if isinstance(depth, int) else 1}, {added})"
    return _written(end, profile, [_CLASSES[policy], "QoSProfile"])


def with_profile_of(end: End, other: End) -> str:
    """Return what to write so that an end has the profile that another takes from rclpy; empty if it takes none."""
    given = other.creation.given("qos_profile")
    module, _, name = (other.sources.resolve(other.creation.source, given) or "").rpartition(".")
    return _written(end, name, [name]) if module == "rclpy.qos" and name else ""


def _written(end: End, profile: str, names: list[str]) -> str:
    """Return the call that makes an end, with a profile as an expression, and the import of its names."""
    call, source = end.creation.call, end.creation.source
    changed = with_arguments(call, {id(end.creation.given("qos_profile")): profile})
    lacking = [name for name in sorted(names) if name not in source.names]
    more = f", with `from rclpy.qos import {', '.join(lacking)}` at the top" if lacking else ""
    return f"write `{changed}`{more}"
