"""What each program did in a run of several, as if watched alone; nothing if that cannot be told."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

Seen = Mapping[str, Any]  # what the observer tells of a run; see `observer.Conductor`


def shared_out(seen: Seen, enclaves: Sequence[str]) -> list[Seen]:
    """Split what was seen of several programs.

    Args:
        seen: what was seen of all of them.
        enclaves: one per program, in which it was started and by which its nodes are known, as the observer
            verified.

    Returns:
        What was seen of each program, in the same form; empty if a program has no node, or if a node, a topic
        or a log line cannot be assigned to one program.
    """
    homes = {node: found[0] for node, found in seen.get("enclaves", {}).items() if len(found) == 1}
    nodes = [{node for node, home in homes.items() if home == enclave} for enclave in enclaves]
    if not all(nodes) or set().union(*nodes) != {*seen["nodes"]} or _has_open(seen, nodes):
        return []
    return [_share(seen, own) for own in nodes]


def _has_open(seen: Seen, nodes: Sequence[Collection[str]]) -> bool:
    """Return whether anything was noted, did not answer, has stopped, or may belong to several programs."""
    owners = [sum(any(node in own for node in ends) for own in nodes) for ends in seen["publishes"].values()]
    lines = [line for log in (seen["log"], *(command["log"] for command in seen["commands"])) for line in log]
    return (
        bool(seen["notes"] or seen["twins"] or seen["stalled"])
        or seen["commanded"] in seen["publishes"]  # a program commands the others
        or {*seen["parameters"]} != {*seen["nodes"]}
        or any(count != 1 for count in owners)
        or any(sum(_is_by(name, own) for own in nodes) != 1 for _, name, _ in lines)
    )


def _share(seen: Seen, own: Collection[str]) -> Seen:
    publishes, subscribes, services = (
        {
            name: {node: types for node, types in nodes.items() if node in own}
            for name, nodes in seen[ends].items()
            if any(node in own for node in nodes)
        }
        for ends in ("publishes", "subscribes", "services")
    )

    def heard(topics: Mapping[str, Any]) -> dict[str, Any]:
        return {topic: found for topic, found in topics.items() if topic in publishes}

    def logged(lines: Sequence[Sequence[str]]) -> list[Sequence[str]]:
        return [line for line in lines if _is_by(line[1], own)]

    def obeyed(command: Seen) -> Seen:
        changed = {
            name: value for name, value in command["parameters"].items() if name.partition(":")[0] in own
        }
        log = logged(command["log"])
        return {**command, "topics": heard(command["topics"]), "log": log, "parameters": changed}

    roles = (("publisher", publishes), ("subscriber", subscribes))
    return {
        **seen,
        "nodes": [node for node in seen["nodes"] if node in own],
        "publishes": publishes,
        "subscribes": subscribes,
        "services": services,
        "qos": {topic: list(_qualities(topic, found, roles)) for topic, found in seen["qos"].items()},
        "parameters": {node: values for node, values in seen["parameters"].items() if node in own},
        "quiet": heard(seen["quiet"]),
        "log": logged(seen["log"]),
        "commands": [obeyed(command) for command in seen["commands"] if seen["commanded"] in subscribes],
        "calls": [
            {**call, "topics": heard(call["topics"])} for call in seen["calls"] if call["service"] in services
        ],
        "final": heard(seen["final"]),
    }


def _qualities(
    topic: str, qualities: Sequence[str], roles: Sequence[tuple[str, Mapping[str, Any]]]
) -> Iterator[str]:
    for role, topics in roles:
        if topic in topics:
            yield from (quality for quality in qualities if quality.startswith(role))


def _is_by(logger: str, nodes: Collection[str]) -> bool:
    """Return whether a logger belongs to one of these nodes, or is a child of such a logger."""
    names = (node.strip("/").replace("/", ".") for node in nodes)
    return any(f"{logger}.".startswith(f"{name}.") for name in names)
