"""Findings about the graph of running nodes, such as topics that do not connect."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ros2lab.diagnose.finding import Finding, ranked
from ros2lab.diagnose.nodes.ros_graph import (
    End,
    Fault,
    NearMiss,
    QosMismatch,
    SharedName,
    TypeMismatch,
    graph_of,
    observe,
)
from ros2lab.diagnose.nodes.topic_faults import COURSE_TOPICS

if TYPE_CHECKING:
    from rclpy.node import Node

EXPECTED_TOPICS = tuple(f"/{name}" for name in sorted(COURSE_TOPICS))


def graph_findings(node: Node) -> list[Finding]:
    """Return the findings for the graph as a node sees it, including the node's own ends of topics."""
    graph = graph_of(observe(node, everything=True), everything=True, expected_topics=EXPECTED_TOPICS)
    return ranked(finding for fault in graph.faults if (finding := finding_of(fault)) is not None)


def finding_of(fault: Fault) -> Finding | None:
    """Return the finding for a fault of the graph; None if nothing is wrong."""
    if isinstance(fault, NearMiss):
        return _near_miss(fault)
    if isinstance(fault, TypeMismatch):
        publisher, subscription = fault.publisher, fault.subscription
        cause = f"On {publisher.topic}, {_short(publisher.node)} publishes {publisher.type} but {_short(subscription.node)} subscribes with {subscription.type}, so no messages arrive."
        return Finding("topic-type", cause, "", "use the same type at both ends", (publisher.topic,))
    if isinstance(fault, QosMismatch):
        cause = (
            f"On {fault.publisher.topic}, the quality of service of {_short(fault.publisher.node)} does not fit "
            f"that of {_short(fault.subscription.node)}, so nothing arrives: {fault.reason}."
        )
        fix = "give both ends the same quality of service"
        return Finding("qos-mismatch", cause, "", fix, (fault.publisher.topic,))
    if isinstance(fault, SharedName):
        cause = (
            f"{fault.count} nodes are named {fault.node}, so what they publish arrives {fault.count} times."
        )
        return Finding("name-twice", cause, "", "stop all but one")
    return None


def _near_miss(fault: NearMiss) -> Finding:
    does, who = _does(fault.ends), _who(fault.ends)
    if fault.meant_ends:
        cause = f"{does} {fault.topic} and {_does(fault.meant_ends)} {fault.meant}: these are two different topics, so they do not connect."
        fix = f"use the same one of the two names in {who} and in {_who(fault.meant_ends)}"
        return Finding("topic-near-miss", cause, "", fix, (fault.topic, fault.meant))
    cause = f"{does} {fault.topic}, but {fault.meant} is a different topic, so they do not connect."
    fix = f"write {fault.meant} in {who}, then build and start it again"
    return Finding("topic-near-miss", cause, "", fix, (fault.topic,))


def _does(ends: tuple[End, ...]) -> str:
    return f"{_who(ends)} {'publishes on' if ends[0].is_publisher else 'listens to'}"


def _who(ends: tuple[End, ...]) -> str:
    return ", ".join(sorted({_short(end.node) for end in ends}))


def _short(node: str) -> str:
    return node.rpartition("/")[2]
