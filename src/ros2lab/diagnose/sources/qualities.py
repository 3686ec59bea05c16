"""The quality of service with which code creates a publisher or a subscription, as far as it is known."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass

from ros2lab.diagnose.sources.known_values import definition
from ros2lab.diagnose.sources.node_source import Creation, NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource


@dataclass(frozen=True)
class Policy:
    """A policy of a quality of service.

    Attributes:
        default: its value where none is given; a time is in s.
        values: its values, those that promise more later; empty for a time, where less is more.
        home: the class of its values.
        words: what it is called in a sentence.
    """

    default: str
    values: tuple[str, ...]
    home: str
    words: str

    def strictness(self, value: str) -> float | None:
        """Return a number that is greater the more a value promises or requires; None if the value is not known."""
        if self.values:
            return float(self.values.index(value)) if value in self.values else None
        return -float(value) if value else None

    def in_words(self, value: str) -> str:
        """Return a value as it is said in a sentence."""
        if self.values:
            return f"{self.words} {value}"
        return f"no {self.words}" if value == _ENDLESS else f"a {self.words} of {value} s"

    def code(self, value: str) -> str:
        """Return a value as code."""
        return f"{self.home}.{value}" if self.values else f"Duration(seconds={value})"


_ENDLESS = "inf"
# The policies in which a publisher must offer what a subscription requires.
POLICIES: Mapping[str, Policy] = {
    "durability": Policy("VOLATILE", ("VOLATILE", "TRANSIENT_LOCAL"), "DurabilityPolicy", "durability"),
    "reliability": Policy("RELIABLE", ("BEST_EFFORT", "RELIABLE"), "ReliabilityPolicy", "reliability"),
    "liveliness": Policy("AUTOMATIC", ("AUTOMATIC", "MANUAL_BY_TOPIC"), "LivelinessPolicy", "liveliness"),
    "deadline": Policy(_ENDLESS, (), "Duration", "deadline"),
    "liveliness_lease_duration": Policy(_ENDLESS, (), "Duration", "liveliness lease"),
}
_HISTORY = ("KEEP_LAST", "KEEP_ALL")
# The parameter of a QoSProfile for each class of policies.
PARAMETERS: Mapping[str, str] = {
    **{policy.home: name for name, policy in POLICIES.items() if policy.values},
    "HistoryPolicy": "history",
}
_DEFAULT = {**{name: policy.default for name, policy in POLICIES.items()}, "history": _HISTORY[0]}


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
        given_here = {p: _value(sources, source, p, written[p]) for p in _DEFAULT if p in written}
        told = {**_DEFAULT, **given_here} if None not in written else {}
    return told


def policy_of(source: PythonSource, node: ast.expr | None) -> str:
    """Return the policy of which an expression is a value, as `ReliabilityPolicy.RELIABLE` is; empty if of none."""
    module, _, home = (source.resolve(node) or "").rpartition(".")[0].rpartition(".")
    return PARAMETERS.get(home.removeprefix("QoS"), "") if module == "rclpy.qos" else ""


def _value(sources: NodeSources, source: PythonSource, policy: str, node: ast.expr) -> str:
    """Return a value of a policy; empty if it is not known."""
    values = POLICIES[policy].values if policy in POLICIES else _HISTORY
    if values:
        name = (sources.resolve(source, node) or "").rpartition(".")[2]
        return name if name in values else ""
    node = source.written(node)
    if not isinstance(node, ast.Call) or sources.resolve(source, node.func) != "rclpy.duration.Duration":
        return ""
    units = {"seconds": 1.0, "nanoseconds": 1e-9}
    given = {keyword.arg: sources.value(source, keyword.value) for keyword in node.keywords}
    known = [
        units[name] * value
        for name, value in given.items()
        if name in units and isinstance(value, (int, float))
    ]
    return f"{sum(known):g}" if known and len(known) == len(given) and not node.args else ""
