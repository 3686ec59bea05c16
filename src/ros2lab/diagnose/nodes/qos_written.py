"""Publishers and subscriptions as they are written with another quality of service."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from ros2lab.diagnose.finding import in_a_row
from ros2lab.diagnose.sources.qualities import POLICIES
from ros2lab.diagnose.sources.syntax_parts import with_arguments

if TYPE_CHECKING:
    from ros2lab.diagnose.nodes.topic_faults import End


def with_policy(end: End, policy: str, value: str) -> str:
    """Return what to write so that an end has a policy, such as `durability` TRANSIENT_LOCAL."""
    source, given = end.creation.source, end.creation.given("qos_profile")
    known = POLICIES[policy]
    written = source.written(given)
    if isinstance(written, ast.Call):
        others = [ast.unparse(argument) for argument in written.args]
        others += [ast.unparse(keyword) for keyword in written.keywords if keyword.arg != policy]
        profile = f"{ast.unparse(written.func)}({', '.join([*others, f'{policy}={known.code(value)}'])})"
    else:
        depth = end.sources.value(source, given)
        profile = f"QoSProfile(depth={depth if isinstance(depth, int) else 1}, {policy}={known.code(value)})"
    return _written(end, profile, [known.home, "QoSProfile"])


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
    of_time = ["from rclpy.duration import Duration"] if "Duration" in lacking else []
    of_qos = [name for name in lacking if name != "Duration"]
    lines = [*of_time, *([f"from rclpy.qos import {', '.join(of_qos)}"] if of_qos else [])]
    more = f", with {in_a_row([f'`{line}`' for line in lines])} at the top" if lines else ""
    return f"write `{changed}`{more}"
