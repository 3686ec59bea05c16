"""What the running nodes tell: topics that do not meet."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from rclpy.qos import QoSCompatibility, qos_check_compatible

from ros2lab.diagnose.finding import Finding, ranked
from ros2lab.diagnose.spelling import is_near_miss
from ros2lab.diagnose.topic_faults import COURSE_TOPICS

if TYPE_CHECKING:
    from rclpy.node import Node

_ALWAYS_THERE = frozenset(("/rosout", "/parameter_events", "/clock"))


def graph_findings(node: Node) -> list[Finding]:
    """Look at the graph as a node sees it; the node's own ends of topics count, too."""
    topics = [name for name, _ in node.get_topic_names_and_types() if name not in _ALWAYS_THERE]
    ends = {
        topic: (node.get_publishers_info_by_topic(topic), node.get_subscriptions_info_by_topic(topic))
        for topic in topics
    }
    found = [*_near_misses(ends), *_same_names(node)]
    for topic, (publishers, listeners) in ends.items():
        found += _mismatches(topic, publishers, listeners)
    return ranked(found)


def _near_misses(ends: dict[str, tuple[list[Any], list[Any]]]) -> Iterator[Finding]:
    course = [f"/{name}" for name in COURSE_TOPICS]
    for topic, (publishers, listeners) in ends.items():
        if topic in course or bool(publishers) == bool(listeners):
            continue
        is_publisher = bool(publishers)
        others = [
            name
            for name, both in ends.items()
            if name != topic and both[is_publisher] and not both[not is_publisher]
        ]
        wanted = next((name for name in [*others, *course] if is_near_miss(topic, name)), None)
        if wanted:
            who = ", ".join(sorted({end.node_name for end in publishers or listeners}))
            yield Finding(
                "topic-near-miss",
                f"{who} {'publishes on' if is_publisher else 'listens to'} {topic}, and {wanted} is another topic: "
                "they do not meet.",
                "",
                f"write {wanted} in {who}, build it again and start it again",
            )


def _mismatches(topic: str, publishers: list[Any], listeners: list[Any]) -> Iterator[Finding]:
    for one in publishers:
        for other in listeners:
            if one.topic_type != other.topic_type:
                yield Finding(
                    "topic-type",
                    f"On {topic}, {one.node_name} publishes {one.topic_type} and {other.node_name} listens for "
                    f"{other.topic_type}: they never hear each other.",
                    "",
                    "use the same type at both ends",
                )
                continue
            verdict, why = qos_check_compatible(one.qos_profile, other.qos_profile)
            if verdict == QoSCompatibility.ERROR:
                yield Finding(
                    "qos-mismatch",
                    f"On {topic}, the quality of service of {one.node_name} does not fit that of {other.node_name}, so "
                    f"nothing arrives: {why.rstrip('; ')}.",
                    "",
                    "give both ends the same quality of service",
                )


def _same_names(node: Node) -> Iterator[Finding]:
    names = Counter(f"{space.rstrip('/')}/{name}" for name, space in node.get_node_names_and_namespaces())
    for name, count in names.items():
        if count > 1 and not name.startswith("/_"):
            yield Finding(
                "name-twice",
                f"{count} nodes are called {name}, so what they publish comes {count} times.",
                "",
                "stop all but one of them",
            )
