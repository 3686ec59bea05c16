"""The facts of the ROS graph, from plain data; and what is drawn and said of them."""

from __future__ import annotations

import pytest
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from ros2lab.diagnose.nodes.ros_graph import (
    End,
    Fault,
    Graph,
    NearMiss,
    Node,
    Observation,
    OneSided,
    QosMismatch,
    ServiceEnd,
    SharedName,
    TypeMismatch,
    graph_of,
    words,
)
from ros2lab.widgets.graph_figure import PX_PER_INCH, WIDEST, graph_figure
from ros2lab.widgets.graph_layout import DIRECTIONS, lay_out
from ros2lab.widgets.graph_scene import Scene, qos_words, scene_of, shortened

STRING, INT = "std_msgs/msg/String", "std_msgs/msg/Int32"
USUAL = QoSProfile(depth=1)
LOSSY = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def publisher(node: str, topic: str, type: str = STRING, qos: QoSProfile = USUAL) -> End:
    return End(node, topic, type, True, qos)


def subscription(node: str, topic: str, type: str = STRING, qos: QoSProfile = USUAL) -> End:
    return End(node, topic, type, False, qos)


def graph(
    *ends: End, nodes: tuple[str, ...] = (), everything: bool = False, expected: tuple[str, ...] = ()
) -> Graph:
    return graph_of(Observation(nodes, ends), everything=everything, expected_topics=expected)


def kinds(graph: Graph) -> list[type[Fault]]:
    return [type(fault) for fault in graph.faults]


def faulty(scene: Scene) -> dict[str, tuple[str, str]]:
    """Return the fault and the badge of each part that is drawn with a fault."""
    parts = (*scene.boxes, *scene.arrows)
    return {part.id: (part.fault, part.badge) for part in parts if part.fault}


def test_a_right_graph_has_nodes_topics_edges_and_no_fault() -> None:
    found = graph(publisher("/a", "/t"), subscription("/b", "/t"), nodes=("/a", "/alone", "/b"))
    assert found.nodes == (Node("/a"), Node("/alone"), Node("/b"))
    assert [(topic.name, topic.types) for topic in found.topics] == [("/t", (STRING,))]
    assert [(e.node, e.medium, e.is_from_node) for e in found.edges] == [
        ("/a", "/t", True),
        ("/b", "/t", False),
    ]
    assert found.faults == ()
    assert words(found) == ["/a -> /t [std_msgs/msg/String] -> /b"]


def test_several_ends_of_a_node_are_one_edge() -> None:
    found = graph(publisher("/a", "/t"), publisher("/a", "/t"), subscription("/a", "/t"))
    assert [len(edge.ends) for edge in found.edges] == [2, 1]


def test_a_node_whose_name_is_not_discovered_yet_is_there_by_its_ends() -> None:
    assert graph(publisher("/a", "/t")).nodes == (Node("/a"),)


@pytest.mark.parametrize("everything", [False, True])
def test_what_every_node_has_is_left_out_unless_asked_for(everything: bool) -> None:
    seen = Observation(
        ("/_hidden", "/a"),
        (publisher("/a", "/rosout"), publisher("/a", "/x/_action/status"), publisher("/_hidden", "/t")),
        (ServiceEnd("/a", "/a/get_parameters", "t", True), ServiceEnd("/a", "/go", "t", True)),
    )
    found = graph_of(seen, everything=everything)
    assert [node.name for node in found.nodes] == (["/_hidden", "/a"] if everything else ["/a"])
    assert len(found.topics) == (3 if everything else 0)
    assert [service.name for service in found.services] == (
        ["/a/get_parameters", "/go"] if everything else ["/go"]
    )


def test_services_point_from_client_to_server() -> None:
    ends = (ServiceEnd("/s", "/go", "t", True), ServiceEnd("/c", "/go", "t", False))
    found = graph_of(Observation(("/c", "/s"), (), ends))
    assert words(found) == ["/c -> /go [t] -> /s"]
    scene = scene_of(found)
    assert [(arrow.source, arrow.target) for arrow in scene.arrows] == [
        ("node /c", "service /go"),
        ("service /go", "node /s"),
    ]
    assert scene.summary == "2 nodes, 0 topics, 1 service"


def test_types_that_differ_are_a_fault_of_both_arrows() -> None:
    found = graph(publisher("/a", "/t", INT), subscription("/b", "/t"))
    assert kinds(found) == [TypeMismatch]
    scene = scene_of(found)
    assert faulty(scene) == {"/t > /b": ("type", "type ≠"), "/a > /t": ("type", "")}
    (said,) = scene.faults
    assert INT in said.text
    assert STRING in said.text


@pytest.mark.parametrize(
    ("offered", "requested", "reason"),
    [
        (LOSSY, USUAL, "best effort publisher and reliable subscription"),
        (USUAL, KEPT, "volatile publisher and transient local subscription"),
        (USUAL, LOSSY, None),
        (KEPT, USUAL, None),
    ],
)
def test_a_publisher_that_offers_less_than_is_requested_is_a_fault(
    offered: QoSProfile, requested: QoSProfile, reason: str | None
) -> None:
    found = graph(publisher("/a", "/t", qos=offered), subscription("/b", "/t", qos=requested))
    assert [fault.reason for fault in found.faults if isinstance(fault, QosMismatch)] == (
        [reason] if reason else []
    )


def test_only_the_arrow_that_carries_nothing_is_drawn_as_faulty() -> None:
    """The publisher reaches another subscription; but all three parts tell of the fault."""
    scene = scene_of(
        graph(publisher("/a", "/t"), subscription("/late", "/t", qos=KEPT), subscription("/ok", "/t"))
    )
    assert faulty(scene) == {"/t > /late": ("qos", "QoS ≠")}
    telling = {part.id for part in (*scene.boxes, *scene.arrows) if part.faults}
    assert telling == {"/t > /late", "topic /t", "node /a", "node /late"}
    assert all("transient local" in part.words for part in scene.boxes if part.id in telling)


def test_the_publishers_arrow_is_faulty_if_the_subscription_receives_from_another() -> None:
    scene = scene_of(
        graph(publisher("/lossy", "/t", qos=LOSSY), publisher("/ok", "/t"), subscription("/b", "/t"))
    )
    assert faulty(scene) == {"/lossy > /t": ("qos", "QoS ≠")}


def test_two_names_nearly_alike_are_joined_by_a_link() -> None:
    found = graph(publisher("/talker", "/chatter"), subscription("/listener", "/chater"))
    assert kinds(found) == [NearMiss, OneSided, OneSided]
    scene = scene_of(found)
    link = next(arrow for arrow in scene.arrows if arrow.kind == "link")
    assert (link.source, link.target, link.badge) == ("topic /chatter", "topic /chater", "name ≈")
    assert len(scene.faults) == 1
    assert scene.notes == (), "said already"


@pytest.mark.parametrize(
    ("ends", "expected"),
    [
        ((publisher("/a", "/state"), subscription("/b", "/status")), ()),  # another word
        ((publisher("/a", "/chatter"), publisher("/b", "/chater")), ()),  # both have the same end
        ((publisher("/a", "/cmd_vel"),), ("/cmd_vel",)),  # as expected
    ],
)
def test_other_names_are_no_near_misses(ends: tuple[End, ...], expected: tuple[str, ...]) -> None:
    assert NearMiss not in kinds(graph(*ends, expected=expected))


def test_a_name_nearly_the_expected_one_is_a_fault_of_the_topic() -> None:
    found = graph(publisher("/a", "/cmd_vell"), expected=("/cmd_vel",))
    assert kinds(found) == [NearMiss, OneSided]
    assert faulty(scene_of(found)) == {"topic /cmd_vell": ("name", "name ≈")}


def test_two_nodes_of_one_name_are_one_box_with_a_badge() -> None:
    found = graph(nodes=("/twin", "/twin", "/_hidden", "/_hidden"), everything=True)
    assert [fault for fault in found.faults if isinstance(fault, SharedName)] == [SharedName("/twin", 2)]
    scene = scene_of(found)
    assert faulty(scene) == {"node /twin": ("twice", "2 nodes")}
    assert scene.summary == "4 nodes, 0 topics"


def test_a_topic_without_its_other_end_is_no_fault_but_a_note() -> None:
    scene = scene_of(graph(publisher("/a", "/out"), subscription("/a", "/in")))
    assert {box.title: box.note for box in scene.boxes} == {
        "/a": "",
        "/in": "nobody publishes here",
        "/out": "nobody subscribes",
    }
    assert scene.notes == ("Nobody publishes on /in.", "Nobody subscribes to /out.")
    assert scene.faults == ()


def test_the_description_says_everything() -> None:
    scene = scene_of(graph(publisher("/a", "/t", INT), subscription("/b", "/t")))
    assert scene.description.startswith("ROS graph with 2 nodes, 1 topic. /a -> /t [")
    assert "no messages arrive" in scene.description
    assert scene_of(Graph()).description == "ROS graph with 0 nodes, 0 topics."


def test_only_published_topics_have_a_rate() -> None:
    scene = scene_of(graph(publisher("/a", "/out"), subscription("/a", "/in")))
    assert {box.title: box.topics for box in scene.boxes} == {"/a": ("/out",), "/in": (), "/out": ("/out",)}


def test_the_still_picture_has_labels_badges_and_sentences() -> None:
    found = graph(
        publisher("/a", "/number", INT),
        subscription("/b", "/number"),
        publisher("/a", "/state"),
        subscription("/b", "/state", qos=KEPT),
        publisher("/a", "/chatter"),
        subscription("/b", "/chater"),
        nodes=("/a", "/a", "/b"),
    )
    scene = scene_of(found)
    sizes = {box.id: box.size for box in scene.boxes}
    layouts = [lay_out(sizes, scene.links, direction) for direction in DIRECTIONS]
    figure = graph_figure(scene, layouts)
    figure.canvas.draw()
    texts = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert {"type ≠", "QoS ≠", "name ≈", "2 nodes", "/chatter", "nobody subscribes"} <= set(texts)
    assert all(said.text in " ".join(texts) for said in scene.faults)
    assert figure.get_figwidth() * PX_PER_INCH <= WIDEST


def test_the_still_picture_of_nothing_says_so() -> None:
    figure = graph_figure(scene_of(Graph()), [lay_out({}, [])])
    assert [text.get_text() for text in figure.axes[0].texts] == ["No node is seen."]


def test_long_names_are_shortened_in_the_middle() -> None:
    assert shortened("/short") == "/short"
    assert shortened("/a_very_long_name_of_a_topic", 11) == "/a_ve…topic"


def test_what_is_unusual_in_a_quality_of_service_is_named() -> None:
    assert qos_words(USUAL) == "reliable, volatile"
    qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT, deadline=Duration(seconds=0.5))
    assert qos_words(qos) == "best effort, volatile, deadline 0.5 s"
