"""Publishers and subscriptions as they are written with another quality of service."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.sources.known_values import definition
from ros2lab.diagnose.sources.node_source import Creation, NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.qualities import PARAMETERS, POLICIES, policy_of
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
    return _written(end.creation, profile, [known.home, "QoSProfile"])


def with_profile_of(end: End, other: End) -> str:
    """Return what to write so that an end has the profile that another takes from rclpy; empty if it takes none."""
    given = other.creation.given("qos_profile")
    module, _, name = (other.sources.resolve(other.creation.source, given) or "").rpartition(".")
    return _written(end.creation, name, [name]) if module == "rclpy.qos" and name else ""


def misplaced_policies(sources: NodeSources) -> Iterator[Finding]:
    """Yield policies that rclpy takes for the integers that they are: as a depth, or as another policy."""
    for creation in sources.creations:
        given = creation.given("qos_profile")
        found = definition(sources, creation, given)
        if given is not None and found and (policy := policy_of(*found)):
            text = ast.unparse(given)
            cause = f"`{text}` is an integer, so {creation.method} takes it for the depth of the queue, and the {policy} remains the default."
            fix = _written(creation, f"QoSProfile(depth=10, {policy}={text})", ["QoSProfile"])
            yield Finding("qos-mismatch", cause, creation.source.at(given), fix)
    for source in sources.sources.values():
        for call in source.calls:
            if sources.resolve(source, call.func) == "rclpy.qos.QoSProfile":
                yield from _misplaced_in(source, call)


def _misplaced_in(source: PythonSource, profile: ast.Call) -> Iterator[Finding]:
    """Yield the parameters of a profile that are given a policy of another kind."""
    given = {keyword.arg or "": keyword.value for keyword in profile.keywords}
    homes = {parameter: home for home, parameter in PARAMETERS.items()}
    for name in (name for name in given if name in {"depth", *homes}):
        policy, text = policy_of(source, source.written(given[name])), ast.unparse(given[name])
        if policy in ("", name):
            continue
        wanted = f"a value of {homes[name]}" if name in homes else "a number"
        cause = f"`{name}={text}` is given the integer that stands for a {policy}, but {name} needs {wanted}."
        fix = (
            f"write {policy}={text} instead" if name in homes else f"write depth=10, {policy}={text} instead"
        )
        fix = f"give {name} {wanted}" if policy in given else fix
        yield Finding("qos-mismatch", cause, source.at(given[name]), fix)


def _written(creation: Creation, profile: str, names: list[str]) -> str:
    """Return the call that makes an end, with a profile as an expression, and the import of its names."""
    call, source = creation.call, creation.source
    changed = with_arguments(call, {id(creation.given("qos_profile")): profile})
    lacking = [name for name in sorted(names) if name not in source.names]
    of_time = ["from rclpy.duration import Duration"] if "Duration" in lacking else []
    of_qos = [name for name in lacking if name != "Duration"]
    lines = [*of_time, *([f"from rclpy.qos import {', '.join(of_qos)}"] if of_qos else [])]
    more = f", with {in_a_row([f'`{line}`' for line in lines])} at the top" if lines else ""
    return f"write `{changed}`{more}"
