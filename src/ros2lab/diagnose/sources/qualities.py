"""The quality of service with which code creates a publisher or a subscription, as far as it is known."""

from __future__ import annotations

import ast
from collections.abc import Mapping

from ros2lab.diagnose.sources.known_values import definition
from ros2lab.diagnose.sources.node_source import Creation, NodeSources

_DEFAULT = {"durability": "VOLATILE", "reliability": "RELIABLE", "history": "KEEP_LAST"}
_VALUES = frozenset(("VOLATILE", "TRANSIENT_LOCAL", "RELIABLE", "BEST_EFFORT", "KEEP_LAST", "KEEP_ALL"))


def policies_of(sources: NodeSources, creation: Creation) -> Mapping[str, str]:
    """Return the policies of a quality of service; one that is not known is missing or empty, and is no default."""
    given = creation.given("qos_profile")
    if "qos_overriding_options" in (creation.arguments or {}):
        return {}  # parameters may change it
    if given is not None and isinstance(sources.value(creation.source, given), int):
        return _DEFAULT
    found = definition(sources, creation, given)
    if found is None:
        return {}
    source, node = found
    name = sources.resolve(source, node.func if isinstance(node, ast.Call) else node)
    told: Mapping[str, str] = {}
    if isinstance(node, ast.Constant):
        told = _DEFAULT
    elif name == "rclpy.qos.qos_profile_sensor_data":
        told = {**_DEFAULT, "reliability": "BEST_EFFORT"}
    elif isinstance(node, ast.Call) and name == "rclpy.qos.QoSProfile":
        written = {keyword.arg: keyword.value for keyword in node.keywords}
        given_here = {
            policy: (sources.resolve(source, written[policy]) or "").rpartition(".")[2]
            for policy in _DEFAULT
            if policy in written
        }
        known = {policy: value if value in _VALUES else "" for policy, value in given_here.items()}
        told = {**_DEFAULT, **known} if None not in written else {}
    return told
