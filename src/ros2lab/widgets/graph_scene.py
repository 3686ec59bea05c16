"""What of a ROS graph is drawn and said: boxes, arrows, marks of faults, and the words to each of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from rclpy.duration import Infinite
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

from ros2lab.diagnose.nodes.graph import finding_of
from ros2lab.diagnose.nodes.ros_graph import (
    Edge,
    End,
    Fault,
    Graph,
    NearMiss,
    OneSided,
    QosMismatch,
    Service,
    ServiceEnd,
    SharedName,
    Topic,
    TypeMismatch,
    words,
)
from ros2lab.widgets.graph_layout import Link

LONGEST_LABEL = 26  # characters
LETTER_WIDTH = 7.25  # px, of a monospaced letter of 12 px
NOTE_LETTER_WIDTH = 6.0  # px, of a letter of 11 px
PADDING = 24.0  # px, left and right of a label together
HEIGHT = 30.0  # px, of a box with one line
NOTE_HEIGHT = 14.0  # px, of the second line

BADGES: Mapping[str, str] = {"type": "type ≠", "qos": "QoS ≠", "name": "name ≈", "twice": "nodes"}
_KINDS: Mapping[type, str] = {TypeMismatch: "type", QosMismatch: "qos", NearMiss: "name", SharedName: "twice"}


@dataclass(frozen=True)
class Row:
    """An end, as the details of a part show it; `what` is the other part's name."""

    what: str
    role: str
    type: str
    qos: str = ""


@dataclass(frozen=True)
class Part:
    """A box or an arrow.

    Attributes:
        id: its own, the same for as long as it is there.
        kind: `node`, `topic` or `service`; of an arrow `message`, `call` or `link`, which joins two topics whose
            names are nearly the same.
        title: what it is, in full.
        rows: its ends.
        topics: those whose rates belong to it, published ones only.
        fault: the kind of fault with which it is drawn, one of `BADGES`, or empty.
        badge: a text beside the mark of the fault, empty if another part bears it.
        faults: sentences about it.
        words: the same for a screen reader.
    """

    id: str
    kind: str
    title: str
    rows: tuple[Row, ...] = ()
    topics: tuple[str, ...] = ()
    fault: str = ""
    badge: str = ""
    faults: tuple[str, ...] = ()
    words: str = ""


@dataclass(frozen=True)
class Box(Part):
    """A node, a topic or a service; `note` stands below its label. Sizes in px."""

    label: str = ""
    note: str = ""
    width: float = 0.0
    height: float = HEIGHT

    @property
    def size(self) -> tuple[float, float]:
        """Width and height in px."""
        return self.width, self.height


@dataclass(frozen=True)
class Arrow(Part):
    """An edge of the graph from one box to another, by their ids."""

    source: str = ""
    target: str = ""


AnyPart = TypeVar("AnyPart", Box, Arrow)


@dataclass(frozen=True)
class Said:
    """A sentence below the picture; `kind` is that of its fault, or empty."""

    kind: str
    text: str


@dataclass(frozen=True)
class Scene:
    """Everything that is drawn and said.

    Attributes:
        boxes: nodes, topics and services.
        arrows: between them.
        faults: a sentence each; the likeliest cause first.
        notes: a sentence each about what is one-sided, and no fault.
        summary: how much there is, in words.
        description: everything, in words.
    """

    boxes: tuple[Box, ...]
    arrows: tuple[Arrow, ...]
    faults: tuple[Said, ...]
    notes: tuple[str, ...]
    summary: str
    description: str

    @property
    def links(self) -> list[Link]:
        """The arrows, as the layout takes them."""
        return [Link(arrow.id, arrow.source, arrow.target, bool(arrow.badge)) for arrow in self.arrows]


def scene_of(graph: Graph) -> Scene:
    """Decide what is drawn and said of a graph."""
    marks = _Marks(graph)
    boxes = [_node_box(graph, node.name) for node in graph.nodes]
    boxes += [_topic_box(topic) for topic in graph.topics]
    boxes += [_service_box(service) for service in graph.services]
    arrows = [_arrow(graph, edge) for edge in graph.edges]
    arrows += [
        _name_link(fault) for fault in graph.faults if isinstance(fault, NearMiss) and fault.meant_ends
    ]
    faults = tuple(Said(_KINDS[type(fault)], text) for fault in graph.faults if (text := sentence(fault)))
    told = {
        name for fault in graph.faults if isinstance(fault, NearMiss) for name in (fault.topic, fault.meant)
    }
    notes = tuple(
        one_sided_note(fault.topic)
        for fault in graph.faults
        if isinstance(fault, OneSided) and fault.topic.name not in told
    )
    summary = _summary(graph)
    description = " ".join(
        (
            f"ROS graph with {summary}.",
            *(f"{line}." for line in words(graph)),
            *(said.text for said in faults),
        )
    )
    return Scene(
        tuple(marks.marked(box) for box in boxes),
        tuple(marks.marked(arrow) for arrow in arrows),
        faults,
        notes,
        summary,
        description,
    )


def sentence(fault: Fault) -> str:
    """Explain a fault and its fix; empty for what is not wrong."""
    finding = finding_of(fault)
    return f"{finding.cause} To fix it, {finding.fix}." if finding else ""


def one_sided_note(topic: Topic) -> str:
    """Say which end a topic lacks."""
    return f"Nobody {'subscribes to' if topic.publishers else 'publishes on'} {topic.name}."


def shortened(name: str, longest: int = LONGEST_LABEL) -> str:
    """Shorten a name in the middle."""
    if len(name) <= longest:
        return name
    head = (longest - 1) // 2
    return f"{name[:head]}…{name[len(name) - (longest - 1 - head) :]}"


def qos_words(qos: QoSProfile) -> str:
    """Name what the graph knows of a quality of service; what is as usual is left out."""
    parts = [
        "best effort" if qos.reliability == ReliabilityPolicy.BEST_EFFORT else "reliable",
        "transient local" if qos.durability == DurabilityPolicy.TRANSIENT_LOCAL else "volatile",
    ]
    for name, duration in (("deadline", qos.deadline), ("lifespan", qos.lifespan)):
        if 0 < duration.nanoseconds < Infinite.nanoseconds:
            parts.append(f"{name} {duration.nanoseconds / 1e9:g} s")
    if qos.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC:
        parts.append("manual liveliness")
    return ", ".join(parts)


class _Marks:
    """Which parts a fault is drawn at, and which sentences belong to a part."""

    def __init__(self, graph: Graph) -> None:
        self._kinds: dict[str, str] = {}
        self._badges: dict[str, str] = {}
        self._sentences: dict[str, list[str]] = {}
        for fault in graph.faults:
            if isinstance(fault, (TypeMismatch, QosMismatch)):
                self._mark_mismatch(graph, fault)
            elif isinstance(fault, NearMiss):
                self._mark_near_miss(fault)
            elif isinstance(fault, SharedName):
                self._mark(_node_id(fault.node), fault, f"{fault.count} {BADGES['twice']}")

    def marked(self, part: AnyPart) -> AnyPart:
        """Return a part with its marks and sentences."""
        told: tuple[str, ...] = tuple(dict.fromkeys(self._sentences.get(part.id, ())))
        return replace(
            part,
            fault=self._kinds.get(part.id, ""),
            badge=self._badges.get(part.id, ""),
            faults=told,
            words=" ".join((part.words, *told)),
        )

    def _mark(self, part: str, fault: Fault, badge: str = "") -> None:
        self._kinds.setdefault(part, _KINDS[type(fault)])
        if badge:
            self._badges.setdefault(part, badge)
        self._tell(part, fault)

    def _tell(self, part: str, fault: Fault) -> None:
        self._sentences.setdefault(part, []).append(sentence(fault))

    def _mark_near_miss(self, fault: NearMiss) -> None:
        if fault.meant_ends:
            self._mark(_topic_id(fault.topic), fault)
            self._mark(_topic_id(fault.meant), fault)
            self._mark(_link_id(fault), fault, BADGES["name"])
        else:
            self._mark(_topic_id(fault.topic), fault, BADGES["name"])

    def _mark_mismatch(self, graph: Graph, fault: TypeMismatch | QosMismatch) -> None:
        """Mark the arrow that carries nothing at all; both, if each of them carries something to others."""
        clashes = [
            (other.publisher, other.subscription)
            for other in graph.faults
            if isinstance(other, (TypeMismatch, QosMismatch))
            and other.publisher.topic == fault.publisher.topic
        ]
        (topic,) = (topic for topic in graph.topics if topic.name == fault.publisher.topic)
        publisher, subscription = fault.publisher, fault.subscription
        is_out_dead = all((publisher, other) in clashes for other in topic.subscriptions)
        is_in_dead = all((other, subscription) in clashes for other in topic.publishers)
        badge = BADGES[_KINDS[type(fault)]]
        if is_in_dead or not is_out_dead:
            self._mark(_edge_id(subscription.node, topic.name, False), fault, badge)
        if is_out_dead or not is_in_dead:
            self._mark(_edge_id(publisher.node, topic.name, True), fault, "" if is_in_dead else badge)
        for part in (_topic_id(topic.name), _node_id(publisher.node), _node_id(subscription.node)):
            self._tell(part, fault)


def _node_box(graph: Graph, name: str) -> Box:
    ends = [end for topic in graph.topics for end in topic.ends if end.node == name]
    calls = [
        end for service in graph.services for end in service.clients + service.servers if end.node == name
    ]
    rows = (
        *(Row(end.topic, _role(end), end.type, qos_words(end.qos)) for end in ends),
        *(Row(end.service, _service_role(end), end.type) for end in calls),
    )
    said = "; ".join(f"{row.role} {row.what}" for row in rows) or "no topics"
    return _box(
        _node_id(name),
        "node",
        name,
        rows=rows,
        topics=_published(graph, (end.topic for end in ends)),
        words=f"Node {name}: {said}.",
    )


def _topic_box(topic: Topic) -> Box:
    note = "nobody publishes here" if not topic.publishers else ""
    note = "nobody subscribes" if not topic.subscriptions else note
    return _box(
        _topic_id(topic.name),
        "topic",
        topic.name,
        note=note,
        rows=tuple(map(_topic_row, topic.ends)),
        topics=(topic.name,) if topic.publishers else (),
        words=f"Topic {topic.name}, {' and '.join(topic.types)}: {_sides(topic)}.",
    )


def _service_box(service: Service) -> Box:
    rows = tuple(Row(end.node, _service_role(end), end.type) for end in service.servers + service.clients)
    said = "; ".join(f"{row.what} {row.role}" for row in rows)
    return _box(
        _service_id(service.name),
        "service",
        service.name,
        note="" if service.servers else "nobody serves it",
        rows=rows,
        words=f"Service {service.name}, {' and '.join(service.types)}: {said}.",
    )


def _box(id: str, kind: str, name: str, *, note: str = "", **facts: Any) -> Box:
    label = shortened(name)
    width = PADDING + max(LETTER_WIDTH * len(label), NOTE_LETTER_WIDTH * len(note))
    if kind != "node":
        width += PADDING / 2  # for the corners
    height = HEIGHT + (NOTE_HEIGHT if note else 0)
    return Box(id, kind, name, label=label, note=note, width=width, height=height, **facts)


def _arrow(graph: Graph, edge: Edge) -> Arrow:
    ends = [end for end in edge.ends if isinstance(end, End)]
    if not ends:
        return _call_arrow(graph, edge)
    (topic,) = (topic for topic in graph.topics if topic.name == edge.medium)
    # The other ends are those that this one meets, or does not.
    others = topic.subscriptions if edge.is_from_node else topic.publishers
    does = "publishes on" if edge.is_from_node else "subscribes to"
    ids = (_node_id(edge.node), _topic_id(edge.medium))
    source, target = ids if edge.is_from_node else ids[::-1]
    return Arrow(
        _edge_id(edge.node, edge.medium, edge.is_from_node),
        "message",
        f"{edge.node} {does} {edge.medium}",
        rows=tuple(map(_topic_row, (*ends, *others))),
        topics=(topic.name,) if topic.publishers else (),
        words=f"{edge.node} {does} {edge.medium}, {' and '.join(topic.types)}, "
        f"{'; '.join(qos_words(end.qos) for end in ends)}.",
        source=source,
        target=target,
    )


def _call_arrow(graph: Graph, edge: Edge) -> Arrow:
    (service,) = (service for service in graph.services if service.name == edge.medium)
    does = "calls" if edge.is_from_node else "serves"
    ids = (_node_id(edge.node), _service_id(edge.medium))
    source, target = ids if edge.is_from_node else ids[::-1]
    return Arrow(
        _edge_id(edge.node, edge.medium, edge.is_from_node),
        "call",
        f"{edge.node} {does} {edge.medium}",
        rows=tuple(Row(end.node, _service_role(end), end.type) for end in service.servers + service.clients),
        words=f"{edge.node} {does} {edge.medium}, {' and '.join(service.types)}.",
        source=source,
        target=target,
    )


def _name_link(fault: NearMiss) -> Arrow:
    names = [fault.topic, fault.meant]
    if not fault.ends[0].is_publisher:
        names.reverse()
    return Arrow(
        _link_id(fault),
        "link",
        f"{names[0]} and {names[1]}",
        words=f"{names[0]} and {names[1]} are spelt almost alike.",
        rows=tuple(map(_topic_row, (*fault.ends, *fault.meant_ends))),
        source=_topic_id(names[0]),
        target=_topic_id(names[1]),
    )


def _topic_row(end: End) -> Row:
    return Row(end.node, _role(end), end.type, qos_words(end.qos))


def _role(end: End) -> str:
    return "publishes" if end.is_publisher else "subscribes"


def _service_role(end: ServiceEnd) -> str:
    return "serves" if end.is_server else "calls"


def _sides(topic: Topic) -> str:
    who = [
        ", ".join(dict.fromkeys(end.node for end in ends)) or "nobody"
        for ends in (topic.publishers, topic.subscriptions)
    ]
    return f"{who[0]} publishes, {who[1]} subscribes"


def _published(graph: Graph, names: Iterable[str]) -> tuple[str, ...]:
    """Keep the topics that somebody publishes, so that they can have a rate."""
    published = {topic.name for topic in graph.topics if topic.publishers}
    return tuple(name for name in dict.fromkeys(names) if name in published)


def _summary(graph: Graph) -> str:
    counts = [(sum(node.count for node in graph.nodes), "node"), (len(graph.topics), "topic")]
    if graph.services:
        counts.append((len(graph.services), "service"))
    return ", ".join(f"{count} {noun}{'' if count == 1 else 's'}" for count, noun in counts)


def _node_id(name: str) -> str:
    return f"node {name}"


def _topic_id(name: str) -> str:
    return f"topic {name}"


def _service_id(name: str) -> str:
    return f"service {name}"


def _edge_id(node: str, medium: str, is_from_node: bool) -> str:
    return f"{node} > {medium}" if is_from_node else f"{medium} > {node}"


def _link_id(fault: NearMiss) -> str:
    return f"{fault.topic} = {fault.meant}"
