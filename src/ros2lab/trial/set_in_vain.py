"""What a launch file sets for a program that did not take it when it ran, where its code does not tell."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ros2lab import every_node
from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.launching.launch_file import LaunchFile
from ros2lab.diagnose.launching.remapped_names import own_names
from ros2lab.diagnose.launching.shared_names import Name
from ros2lab.diagnose.launching.started_faults import Started, started_in
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.grading.evidence import Run

_OF_TOPICS = frozenset(("create_publisher", "create_subscription", "create_timer"))


def set_in_vain(look: Look, runs: Mapping[str, Run]) -> Iterator[Finding]:
    """Yield the namespaces and remappings of launch files that programs did not take, which ran with them.

    Args:
        look: the workspace.
        runs: a run of each program alone, by its name.
    """
    for file in look.launch_files if runs else ():
        nodes = [node for node in started_in(file, look.with_sources) if not own_names(node)]
        seen = {node.module: names for node in nodes if (names := _seen(node, runs))}
        moved = {node.module for node in nodes if node.launched.remappings}
        plain = {module: names for module, names in seen.items() if module not in moved}
        yield from look.shared_names(file, plain).faults() if plain else ()
        for node in nodes:
            yield from _unused(file, node, seen.get(node.module, []), look)


def _seen(node: Started, runs: Mapping[str, Run]) -> list[Name]:
    """Return the names of topics that a program was seen to use; none if it may have others, or did not make all."""
    files, run = node.sources.around(node.module), runs.get(str(node.launched.executable))
    if files is None or run is None or not _has_only_topics(files):
        return []
    ends: dict[str, set[str]] = {}
    for method, seen in (("create_publisher", run.publishes), ("create_subscription", run.subscribes)):
        for topic in seen.keys() - every_node.HIDDEN_TOPICS:
            if not topic.endswith(every_node.OF_MANAGED):
                ends.setdefault(topic, set()).add(method)
    made = sum(creation.method != "create_timer" for creation in files.creations)
    names = [Name(name, frozenset(methods), (node.launched.place,)) for name, methods in sorted(ends.items())]
    return names if sum(len(one.methods) for one in names) >= made else []


def _has_only_topics(files: NodeSources) -> bool:
    """Return whether some files make nothing but publishers, subscriptions and timers, as far as they tell."""
    imports = (imported for source in files.sources.values() for imported in source.imports)
    made = {creation.method for creation in files.creations}
    return made <= _OF_TOPICS and not any(one.target.startswith("rclpy.action") for one in imports)


def _unused(file: LaunchFile, node: Started, names: list[Name], look: Look) -> Iterator[Finding]:
    """Yield the remappings of which a program did not use the new name, when it ran with them."""
    is_its_own = look.launched.get((node.package.name, str(node.launched.executable))) == node
    seen = [one.name for one in names]
    for old, new in node.launched.remappings if seen and is_its_own else ():
        if not isinstance(new, str) or node.resolved_alone(new) in seen or ":" in old or old.startswith("~"):
            continue
        cause = f"{file.giver} remaps {old!r} to {new!r}, but {node.launched.executable} does not use it: when it ran, its topics were {in_a_row(seen)}."
        fix = "write the name that the code has as the first name of the remapping, as `ros2 node info` shows it without the remapping"
        yield Finding("remap-unknown", cause, node.launched.place_of(old, "remappings"), fix)
