"""The ROS graph: nodes, topics and services, who talks to whom, and what does not fit.

`observe` reads a node's view of the graph into plain data; `graph_of` makes the facts from the data alone.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from rclpy.node import NodeNameNonExistentError
from rclpy.qos import QoSCompatibility, QoSProfile, qos_check_compatible

from ros2lab import every_node
from ros2lab.diagnose.sources.spelling import is_near_miss

if TYPE_CHECKING:
    from rclpy.node import Node as RclpyNode

_EVERY_NODES_SERVICES = frozenset(
    (
        *("describe_parameters", "get_parameter_types", "get_parameters", "get_type_description"),
        *("list_parameters", "set_parameters", "set_parameters_atomically"),
    )
)


@dataclass(frozen=True)
class End:
    """A publisher or a subscription.

    Attributes:
        type: its message type, such as `std_msgs/msg/String`.
        is_publisher: False for a subscription.
        qos: what it offers or requests; history and depth are unknown to the graph.
    """

    node: str
    topic: str
    type: str
    is_publisher: bool
    qos: QoSProfile


@dataclass(frozen=True)
class ServiceEnd:
    """A server or a client of a service; attributes as of an `End`."""

    node: str
    service: str
    type: str
    is_server: bool


@dataclass(frozen=True)
class Observation:
    """What a node sees of the graph, as plain data.

    Attributes:
        nodes: full names, sorted; a name that several nodes have appears once for each.
        ends: sorted by topic, publishers first, then by node.
        service_ends: sorted by service, servers first, then by node; empty if services were not read.
    """

    nodes: tuple[str, ...] = ()
    ends: tuple[End, ...] = ()
    service_ends: tuple[ServiceEnd, ...] = ()


@dataclass(frozen=True)
class Node:
    """A node name, and how many nodes have it."""

    name: str
    count: int = 1


@dataclass(frozen=True)
class Topic:
    """A topic with its publishers and subscriptions."""

    name: str
    publishers: tuple[End, ...] = ()
    subscriptions: tuple[End, ...] = ()

    @property
    def ends(self) -> tuple[End, ...]:
        """Publishers, then subscriptions."""
        return self.publishers + self.subscriptions

    @property
    def types(self) -> tuple[str, ...]:
        """The types of its ends, sorted; more than one if they differ."""
        return tuple(sorted({end.type for end in self.ends}))


@dataclass(frozen=True)
class Service:
    """A service with its servers and clients."""

    name: str
    servers: tuple[ServiceEnd, ...] = ()
    clients: tuple[ServiceEnd, ...] = ()

    @property
    def types(self) -> tuple[str, ...]:
        """The types of its ends, sorted; more than one if they differ."""
        return tuple(sorted({end.type for end in self.servers + self.clients}))


@dataclass(frozen=True)
class Edge:
    """An arrow between a node and a topic or service.

    Attributes:
        is_from_node: whether it leads away from the node, as messages that it publishes and requests that it sends do.
        ends: the ends of the node that it stands for.
    """

    node: str
    medium: str
    is_from_node: bool
    ends: tuple[End, ...] | tuple[ServiceEnd, ...]


@dataclass(frozen=True)
class TypeMismatch:
    """A publisher and a subscription of one topic with different types, which never connect."""

    publisher: End
    subscription: End


@dataclass(frozen=True)
class QosMismatch:
    """A publisher that offers less than a subscription requests; `reason` says what, in rclpy's words."""

    publisher: End
    subscription: End
    reason: str


@dataclass(frozen=True)
class NearMiss:
    """A topic with only one kind of end, spelt almost like another that lacks exactly that kind.

    Attributes:
        topic: the name that is probably wrong.
        meant_ends: those of the other topic; empty if it is only expected, and nobody uses it yet.
    """

    topic: str
    meant: str
    ends: tuple[End, ...]
    meant_ends: tuple[End, ...] = ()


@dataclass(frozen=True)
class SharedName:
    """Several nodes with the same name."""

    node: str
    count: int


@dataclass(frozen=True)
class OneSided:
    """A topic without publishers, or without subscriptions: nothing wrong yet."""

    topic: Topic


Fault: TypeAlias = "TypeMismatch | QosMismatch | NearMiss | SharedName | OneSided"


@dataclass(frozen=True)
class Graph:
    """The facts; all parts are sorted by name.

    Attributes:
        faults: what does not fit, and, last, what is one-sided.
    """

    nodes: tuple[Node, ...] = ()
    topics: tuple[Topic, ...] = ()
    services: tuple[Service, ...] = ()
    faults: tuple[Fault, ...] = ()

    @property
    def edges(self) -> tuple[Edge, ...]:
        """Who talks to whom; several ends of one node at one topic are one edge."""
        return (
            *_edges((topic.name, True, topic.publishers) for topic in self.topics),
            *_edges((topic.name, False, topic.subscriptions) for topic in self.topics),
            *_edges((service.name, True, service.clients) for service in self.services),
            *_edges((service.name, False, service.servers) for service in self.services),
        )


def observe(node: RclpyNode, *, services: bool = False, everything: bool = False) -> Observation:
    """Read the graph as a node sees it, with its own ends; if asked, with services, which takes time, or what every node has."""
    names = [(name, space) for name, space in node.get_node_names_and_namespaces()]
    topics = [name for name, _ in node.get_topic_names_and_types()]
    ends = [
        end
        for topic in topics
        if everything or not is_hidden_topic(topic)
        for infos, is_publisher in (
            (node.get_publishers_info_by_topic(topic), True),
            (node.get_subscriptions_info_by_topic(topic), False),
        )
        for end in (_end(info, topic, is_publisher) for info in infos)
    ]
    return Observation(
        nodes=tuple(sorted(full_name(name, space) for name, space in names)),
        ends=tuple(sorted(ends, key=lambda end: (end.topic, not end.is_publisher, end.node, end.type))),
        service_ends=tuple(_service_ends(node, names)) if services else (),
    )


def graph_of(
    observation: Observation, *, everything: bool = False, expected_topics: Iterable[str] = ()
) -> Graph:
    """Derive the graph from an observation.

    Args:
        observation: what was seen.
        everything: whether to keep what every node has and what is hidden: /rosout, /parameter_events, the
            services of parameters, and every name with a part that begins with an underscore.
        expected_topics: names that are meant to be used, such as a course's; a near miss may be one of them.
    """
    seen = observation if everything else _without_hidden(observation)
    nodes = _nodes_of(seen)
    topics = tuple(
        Topic(name, *_two_sides(end for end in seen.ends if end.topic == name))
        for name in sorted({end.topic for end in seen.ends})
    )
    services = tuple(
        Service(name, *_two_sides(end for end in seen.service_ends if end.service == name))
        for name in sorted({end.service for end in seen.service_ends})
    )
    return Graph(nodes, topics, services, tuple(_faults(nodes, topics, list(expected_topics))))


def _two_sides(ends: Iterable[Any]) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """Return the publishers, or servers, among some ends, and the others."""
    sides: tuple[list[Any], list[Any]] = ([], [])
    for end in ends:
        sides[not (end.is_publisher if isinstance(end, End) else end.is_server)].append(end)
    return tuple(sides[0]), tuple(sides[1])


def _nodes_of(seen: Observation) -> tuple[Node, ...]:
    counts = Counter(seen.nodes)
    # The ends of a node may be discovered before its name.
    for name in {*(end.node for end in seen.ends), *(end.node for end in seen.service_ends)} - set(counts):
        counts[name] = 1
    return tuple(Node(name, counts[name]) for name in sorted(counts))


def words(graph: Graph) -> list[str]:
    """Say who talks to whom: one line per topic, then one line per service.

    Returns:
        Such as `/talker -> /news [std_msgs/msg/String] -> /listener`; `nobody` stands for a missing end.
    """
    sides = [(topic.name, topic.types, topic.publishers, topic.subscriptions) for topic in graph.topics]
    calls = [(service.name, service.types, service.clients, service.servers) for service in graph.services]
    return [
        f"{_who(sources)} -> {name} [{', '.join(types)}] -> {_who(targets)}"
        for name, types, sources, targets in (*sides, *calls)
    ]


def full_name(name: str, namespace: str) -> str:
    """Return a node's full name, such as `/robot/driver`."""
    return f"{namespace.rstrip('/')}/{name}"


def is_hidden_topic(name: str) -> bool:
    """Return whether a topic is one that every node has, or one that is hidden by its name."""
    return name in every_node.TOPICS or "/_" in name


def _is_hidden_service(name: str) -> bool:
    return name.rpartition("/")[2] in _EVERY_NODES_SERVICES or "/_" in name


def _is_hidden_node(name: str) -> bool:
    return name.rpartition("/")[2].startswith("_")


def _without_hidden(seen: Observation) -> Observation:
    return Observation(
        tuple(name for name in seen.nodes if not _is_hidden_node(name)),
        tuple(end for end in seen.ends if not (is_hidden_topic(end.topic) or _is_hidden_node(end.node))),
        tuple(e for e in seen.service_ends if not (_is_hidden_service(e.service) or _is_hidden_node(e.node))),
    )


def _end(info: Any, topic: str, is_publisher: bool) -> End:
    name = full_name(info.node_name, info.node_namespace)
    return End(name, topic, info.topic_type, is_publisher, info.qos_profile)


def _service_ends(node: RclpyNode, names: list[tuple[str, str]]) -> list[ServiceEnd]:
    found = []
    for name, space in sorted(set(names)):
        for ask, is_server in (
            (node.get_service_names_and_types_by_node, True),
            (node.get_client_names_and_types_by_node, False),
        ):
            try:
                listed = ask(name, space)
            except NodeNameNonExistentError:  # it has gone in the meantime
                continue
            found += [
                ServiceEnd(full_name(name, space), service, kind, is_server)
                for service, kinds in listed
                for kind in kinds
            ]
    return sorted(found, key=lambda end: (end.service, not end.is_server, end.node, end.type))


def _edges(sides: Iterable[tuple[str, bool, tuple[Any, ...]]]) -> Iterator[Edge]:
    for medium, is_from_node, ends in sides:
        for node in sorted({end.node for end in ends}):
            yield Edge(node, medium, is_from_node, tuple(end for end in ends if end.node == node))


def _faults(nodes: tuple[Node, ...], topics: tuple[Topic, ...], expected: list[str]) -> Iterator[Fault]:
    judged = [topic for topic in topics if topic.name not in every_node.HIDDEN_TOPICS]
    yield from _near_misses(judged, expected)
    for node in nodes:
        if node.count > 1 and not _is_hidden_node(node.name):
            yield SharedName(node.name, node.count)
    for topic in judged:
        yield from _mismatches(topic)
    for topic in topics:
        if topic.name not in every_node.TOPICS and not (topic.publishers and topic.subscriptions):
            yield OneSided(topic)


def _near_misses(topics: list[Topic], expected: list[str]) -> Iterator[NearMiss]:
    told: set[str] = set()
    for topic in topics:
        if topic.name in expected or (topic.publishers and topic.subscriptions):
            continue
        # Both are one-sided, so they complete each other if just one of them has publishers.
        others = {
            other.name: other.ends
            for other in topics
            if bool(other.publishers) != bool(topic.publishers)
            and bool(other.subscriptions) != bool(topic.subscriptions)
            # A node that uses both names means both.
            and {end.node for end in topic.ends}.isdisjoint(end.node for end in other.ends)
        }
        elsewhere = [name for name, ends in others.items() if _is_in_another_namespace(topic, name, ends)]
        near = (name for name in [*others, *expected] if is_near_miss(topic.name, name))
        meant = next(itertools.chain(near, elsewhere), None)
        if meant and meant not in told:
            told.add(topic.name)
            yield NearMiss(topic.name, meant, topic.ends, others.get(meant, ()))


def _is_in_another_namespace(topic: Topic, name: str, ends: tuple[End, ...]) -> bool:
    is_same_type = {end.type for end in topic.ends} == {end.type for end in ends}
    return is_same_type and name.rpartition("/")[2] == topic.name.rpartition("/")[2]


def _mismatches(topic: Topic) -> Iterator[TypeMismatch | QosMismatch]:
    for publisher in topic.publishers:
        for subscription in topic.subscriptions:
            if publisher.type != subscription.type:
                yield TypeMismatch(publisher, subscription)
                continue
            verdict, why = qos_check_compatible(publisher.qos, subscription.qos)
            if verdict == QoSCompatibility.ERROR:
                yield QosMismatch(publisher, subscription, _reasons(why))


def _reasons(why: str) -> str:
    """Turn rclpy's `ERROR: Best effort publisher …;ERROR: …;` into one text."""
    parts = [part.strip().removeprefix("ERROR: ") for part in why.split(";")]
    return " and ".join(part[:1].lower() + part[1:] for part in parts if part)


def _who(ends: Iterable[Any]) -> str:
    return ", ".join(sorted({end.node for end in ends})) or "nobody"
