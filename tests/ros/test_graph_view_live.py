"""The picture of the ROS graph at a real session, with nodes of their own contexts, and each fault."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger

from deadlines import DEADLINE
from ros2lab.session import LabSession
from ros2lab.widgets import GraphView

KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def stranger(domain_id: int) -> Iterator[Callable[[str], Node]]:
    """Return what makes nodes, each in a context of its own: as far as the graph goes, in another process."""
    made: list[tuple[Node, Context]] = []

    def make(name: str) -> Node:
        context = Context()
        rclpy.init(context=context, domain_id=domain_id)
        made.append((Node(name, context=context, start_parameter_services=False), context))
        return made[-1][0]

    yield make
    for node, context in made:
        node.destroy_node()
        context.try_shutdown()


class Talker(Node):
    """Publishes at 20 Hz."""

    def __init__(self) -> None:
        super().__init__("talker")
        self._publisher = self.create_publisher(String, "/weather", 10)
        self.create_timer(0.05, lambda: self._publisher.publish(String()))


def eventually(view: GraphView, name: str, is_right: Callable[[Any], bool]) -> None:
    """Wait until a trait of the view is right; the redraw thread changes it."""
    is_there = threading.Event()

    def check(_: object = None) -> None:
        if is_right(getattr(view, name)):
            is_there.set()

    view.observe(check, name)
    check()
    assert is_there.wait(DEADLINE), f"{name} is {getattr(view, name)!r}"
    view.unobserve(check, name)


def titles(scene: Any) -> set[str]:
    return {box["title"] for box in scene["boxes"]}


def sees_fault(view: GraphView, kind: str) -> None:
    """Wait until a fault of a kind, and no other, is drawn and explained."""
    eventually(view, "scene", lambda scene: [said["kind"] for said in scene["faults"]] == [kind])
    drawn = [part["fault"] for part in (*view.scene["boxes"], *view.scene["arrows"]) if part["fault"]]
    assert set(drawn) == {kind}
    assert view.scene["faults"][0]["text"] in view.description


def test_nodes_appear_and_disappear_by_themselves(session: LabSession) -> None:
    view = GraphView(session)
    assert titles(view.scene) == {"/ros2lab"}
    session.run(Talker)
    eventually(view, "scene", lambda scene: titles(scene) == {"/ros2lab", "/talker", "/weather"})
    session.stop("talker")
    eventually(view, "scene", lambda scene: titles(scene) == {"/ros2lab"})


def test_a_rate_is_measured_while_somebody_asks_and_the_graph_does_not_show_it(session: LabSession) -> None:
    session.run(Talker)
    view = GraphView(session)
    eventually(view, "scene", lambda scene: "/weather" in titles(scene))
    subscriptions = len(list(session.node.subscriptions))
    view._on_message(view, {"measure": ["/weather"]}, [])
    assert len(list(session.node.subscriptions)) == subscriptions + 1
    eventually(view, "rates", lambda rates: rates.get("/weather", "").endswith(" Hz"))
    assert [arrow["id"] for arrow in view.scene["arrows"]] == ["/talker > /weather"]
    view._on_message(view, {"measure": []}, [])
    assert len(list(session.node.subscriptions)) == subscriptions


def test_two_types_on_one_topic(session: LabSession, stranger: Callable[[str], Node]) -> None:
    view = GraphView(session)
    stranger("counter").create_publisher(Int32, "/weather", 10)
    stranger("reader").create_subscription(String, "/weather", print, 10)
    sees_fault(view, "type")


def test_two_qualities_of_service(session: LabSession, stranger: Callable[[str], Node]) -> None:
    view = GraphView(session)
    session.run(Talker)
    stranger("late").create_subscription(String, "/weather", print, KEPT)
    sees_fault(view, "qos")


def test_two_names_nearly_alike(session: LabSession, stranger: Callable[[str], Node]) -> None:
    view = GraphView(session)
    session.run(Talker)
    stranger("reader").create_subscription(String, "/wether", print, 10)
    sees_fault(view, "name")


def test_two_nodes_of_one_name(session: LabSession, stranger: Callable[[str], Node]) -> None:
    view = GraphView(session)
    session.run(Talker)
    stranger("talker")
    sees_fault(view, "twice")
    assert view.scene["summary"] == "3 nodes, 1 topic"


def test_services_come_with_a_click_and_without_those_of_every_node(
    session: LabSession, stranger: Callable[[str], Node]
) -> None:
    server = session.run(Talker)
    server.create_service(Trigger, "/reset", print)
    stranger("caller").create_client(Trigger, "/reset")
    view = GraphView(session)
    eventually(view, "scene", lambda scene: "/caller" in titles(scene))
    assert "/reset" not in titles(view.scene)
    view.services = True
    arrows = {"/caller > /reset", "/reset > /talker"}
    eventually(view, "scene", lambda scene: arrows <= {arrow["id"] for arrow in scene["arrows"]})
    assert "/talker/get_parameters" not in titles(view.scene)
    view.everything = True
    eventually(view, "scene", lambda scene: "/talker/get_parameters" in titles(scene))


def test_closing_the_session_closes_a_view_that_measures(session: LabSession) -> None:
    session.run(Talker)
    view = GraphView(session)
    eventually(view, "scene", lambda scene: "/weather" in titles(scene))
    view._on_message(view, {"measure": ["/weather"]}, [])
    session.close()
    assert view.is_closed
    assert "/talker -> /weather" in view.description
