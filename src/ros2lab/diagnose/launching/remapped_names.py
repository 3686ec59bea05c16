"""Remappings in launch files whose first name is none that the node uses."""

from __future__ import annotations

import ast
import difflib
import itertools
from collections.abc import Iterator, Sequence
from typing import Any

from ros2lab import every_node
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_file import LaunchFile
from ros2lab.diagnose.launching.started_faults import Started
from ros2lab.diagnose.sources.node_source import CREATORS, NodeSources
from ros2lab.diagnose.sources.spelling import is_near_miss, nearest

_MOST_NAMES = 5  # of a node, among which the meant ones are looked for


def unknown_names(file: LaunchFile, nodes: Sequence[Started]) -> Iterator[Finding]:
    """Yield remappings whose first name none of the nodes has that are given it; all their names are known."""
    known = {id(node.launched): own_names(node) for node in nodes}
    for node in nodes:
        for topic, new in node.launched.remappings:
            # A remapping given to several nodes is meant for those that use the name.
            given = [launched for launched in file.nodes if (topic, new) in launched.remappings]
            takers = [other for other in nodes if any(other.launched is launched for launched in given)]
            names = [known[id(other.launched)] for other in takers]
            if len(takers) < len(given) or not all(names):
                continue
            if any(_is_among(topic, own, other) for own, other in zip(names, takers, strict=True)):
                continue
            written = {name for taken in names for name in taken}
            own = {name.lstrip("/") for name in written}
            if topic.lstrip("/") in own:  # the node is in a namespace, so a slash makes it another topic
                yield _of_another_space(file, node, topic, written)
                continue
            if len(given) > 1 and not nearest(topic.lstrip("/"), own, 0.6):
                continue  # such as the transforms, which a launch file may rename for all nodes alike
            others = (other for other in nodes if other is not node)
            beside = {name.lstrip("/") for other in others for name in known[id(other.launched)]}
            wanted = _wanted(node, topic, nodes, own)
            yield _remapped(file, node, (topic, new), (own, beside), wanted)


def _wanted(node: Started, topic: str, nodes: Sequence[Started], own: set[str]) -> str:
    """Return the name that a remapping's first name was meant to be; empty if that is not clear.

    It is none that another remapping of the node takes already; of several unknown ones, each has its own. If the
    new name is one that others only publish, or only subscribe to, it is the name of the other end.
    """
    given = [(old.lstrip("/"), new) for old, new in node.launched.remappings]
    free = sorted(own - {old for old, _ in given})
    lost = [(old, new) for old, new in given if old not in own]
    fitting = [
        pairs
        for names in itertools.permutations(free, len(lost))
        if len(free) <= _MOST_NAMES
        for pairs in [[*zip(lost, names, strict=True)]]
        if all(_may_be(node, name, new, nodes) for (_, new), name in pairs)
    ]
    if len(fitting) > 1 and len(lost) > 1:
        fitting = [max(fitting, key=_total)]
    if len(fitting) == 1:
        return next((name for (old, _), name in fitting[0] if old == topic.lstrip("/")), "")
    return nearest(topic.lstrip("/"), {names[0][1] for names in fitting} or free, 0.6) or ""


def _total(pairs: Sequence[tuple[tuple[str, Any], str]]) -> float:
    """Return how similar the names of pairs are, all together."""
    return sum(difflib.SequenceMatcher(None, old, name).ratio() for (old, _), name in pairs)


def _may_be(node: Started, name: str, new: Any, nodes: Sequence[Started]) -> bool:
    """Return whether one of a node's names may get a new one, by which end of a topic the others have there."""
    own = {end.is_publisher for end, plain, _ in node.ends if plain.lstrip("/") == name.lstrip("~/")}
    others = (other for other in nodes if other is not node)
    whole = node.resolved_alone(new) if isinstance(new, str) else ""
    there = {end.is_publisher for other in others for end, _, full in other.ends if full == whole}
    return len(own) != 1 or len(there) != 1 or own != there


def own_names(node: Started) -> set[str]:
    """Return the names of a node's topics and services; empty if it may have others."""
    files = node.sources.around(node.module)
    if files and any(CREATORS.keys() & node_class.methods.keys() for node_class in files.classes.values()):
        return set()  # what its own way of creating them makes is not known
    for source in files.sources.values() if files else ():
        called = {id(call.func) for call in source.calls}
        for inner in source.nodes:
            if (
                isinstance(inner, ast.Attribute)
                and inner.attr.startswith("create_")
                and id(inner) not in called
            ):
                return set()
        if any(imported.target.startswith("rclpy.action") for imported in source.imports):
            return set()
    return _names(files) if files else set()


def _is_among(topic: str, names: set[str], node: Started) -> bool:
    """Return whether a remapping's first name is one of a node's names, or may be a hidden one."""
    is_every_nodes = f"/{topic.lstrip('/')}" in every_node.HIDDEN_TOPICS or topic.startswith(("~", "_"))
    is_below_node = node.name in topic.split("/") or ":" in topic
    is_named = not node.namespace and topic.lstrip("/") in {name.lstrip("~/") for name in names}
    is_resolved = node.resolved_alone(topic) in {node.resolved_alone(name) for name in names}
    return is_every_nodes or is_below_node or is_named or is_resolved


def _of_another_space(file: LaunchFile, node: Started, topic: str, written: set[str]) -> Finding:
    """Return a finding about a remapping whose first name differs from a node's name only by the slash before it."""
    meant = next(name for name in sorted(written) if name.lstrip("/") == topic.lstrip("/"))
    full = node.resolved_alone(meant)
    cause = f"{file.giver} remaps {topic!r}, which is {node.resolved_alone(topic)}, but {node.launched.executable} is in the namespace {node.namespace}, and its {meant} is {full}: the remapping changes nothing."
    fix = f"write {meant!r} as the first name of the remapping"
    return Finding("remap-unknown", cause, node.launched.place_of(topic, "remappings"), fix)


def _remapped(
    file: LaunchFile,
    node: Started,
    renamed: tuple[str, Any],
    names: tuple[set[str], set[str]],
    wanted: str,
) -> Finding:
    """Return a finding about a remapping whose first name is none of a node's names, beside those of the others."""
    (topic, new), (own, beside) = renamed, names
    there = ", ".join(repr(name) for name in sorted(own))
    cause = f"{file.giver} remaps {topic!r}, but {node.launched.executable} does not use it: the first name must be the one in the code, which uses {there}."
    is_turned = isinstance(new, str) and new.lstrip("/") in own
    fix = f"write one of these as the first name of the remapping: {there}"
    fix = f"write {wanted!r} as the first name of the remapping" if wanted else fix
    fix = fix if is_near_miss(topic.lstrip("/"), wanted) else f"{fix}, or remove it if no name is to change"
    if is_turned:
        turned = f"write ({new!r}, {topic!r}) instead of ({topic!r}, {new!r})"
        is_met, is_met_turned = new.lstrip("/") in beside, topic.lstrip("/") in beside
        fix = f"remove it if {new!r} is right; otherwise {turned}" if is_met == is_met_turned else turned
        fix = "remove it" if is_met and not is_met_turned else fix
    return Finding("remap-unknown", cause, node.launched.place_of(topic, "remappings"), fix)


def _names(files: NodeSources) -> set[str]:
    """Return the names of all topics and services, as they are written; empty if any is not known."""
    created = [creation for creation in files.creations if creation.method != "create_timer"]
    names = [files.value(creation.source, creation.given("topic", "srv_name")) for creation in created]
    return set(names) if all(isinstance(name, str) for name in names) else set()
