"""The monitor, the form and the pad at a real session, with other nodes and processes."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
import rclpy
from geometry_msgs.msg import Point, Pose, PoseArray, PoseWithCovarianceStamped, Twist
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

from deadlines import DEADLINE
from ros2lab.message_schema import NOW, FormError
from ros2lab.session import LabSession
from ros2lab.widgets import MessageForm, Teleop, TopicMonitor

FLOOD = 3000  # messages
FLOODER = f"""
import time
import rclpy
from geometry_msgs.msg import Point

rclpy.init()
node = rclpy.create_node("flooder")
publisher = node.create_publisher(Point, "/flood", {FLOOD})
while not publisher.get_subscription_count():
    time.sleep(0.01)
begin = time.monotonic()
for n in range({FLOOD}):
    publisher.publish(Point(x=float(n)))
    time.sleep(max(0.0, begin + (n + 1) / 1000 - time.monotonic()))
input()
node.destroy_node()
rclpy.shutdown()
"""


class Talk:
    """What a widget tells the browser."""

    def __init__(self, widget: Any, monkeypatch: pytest.MonkeyPatch) -> None:
        self._widget = widget
        self._changed = threading.Condition()
        self._heard: list[dict[str, Any]] = []
        monkeypatch.setattr(widget, "send", self._hear)

    def _hear(self, content: dict[str, Any], buffers: Any = None) -> None:
        with self._changed:
            self._heard.append(content)
            self._changed.notify_all()

    def tell(self, **content: Any) -> None:
        self._widget._handle_custom_msg(content, [])

    def wait_for(self, is_it: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        def found() -> dict[str, Any] | None:
            return next((content for content in self._heard if is_it(content)), None)

        with self._changed:
            assert self._changed.wait_for(lambda: found() is not None, DEADLINE), self._heard[-3:]
            content = found()
        assert content is not None
        return content


def until(is_right: Callable[[], bool]) -> None:
    """Wait for what has no event of its own."""
    deadline = time.monotonic() + DEADLINE
    while not is_right():
        assert time.monotonic() < deadline
        time.sleep(0.01)


@contextmanager
def other_context(domain_id: int) -> Iterator[tuple[Node, Callable[[Callable[[], bool]], None]]]:
    """Make a node that has nothing to do with the session, and a function that spins it until something holds."""
    context = Context()
    rclpy.init(context=context, domain_id=domain_id)
    node = Node("other", context=context, start_parameter_services=False)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)

    def spin_until(is_right: Callable[[], bool]) -> None:
        deadline = time.monotonic() + DEADLINE
        while not is_right():
            assert time.monotonic() < deadline
            executor.spin_once(timeout_sec=0.1)

    try:
        yield node, spin_until
    finally:
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()


# The monitor


def test_the_monitor_shows_nested_messages_and_arrays(
    session: LabSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    monitor = TopicMonitor(session, "/scan")
    talk = Talk(monitor, monkeypatch)
    message = LaserScan(ranges=[1.5] * 640)
    message.header.frame_id = "laser"
    session.publish("/scan", message)
    content = talk.wait_for(lambda content: "tree" in content)
    tree = {child["name"]: child for child in content["tree"]["children"]}
    assert tree["header"]["children"][1]["text"] == '"laser"'
    assert tree["ranges"]["text"] == "640 elements: 1.5, 1.5, 1.5, 1.5, …"
    assert content["size"] > 640 * 4
    assert monitor.type_name == "sensor_msgs/msg/LaserScan"


def test_the_monitor_counts_every_message_of_a_flood(session: LabSession, domain_id: int) -> None:
    monitor = TopicMonitor(session, "/flood", Point)
    flooder = subprocess.Popen([sys.executable, "-c", FLOODER], stdin=subprocess.PIPE)
    try:
        until(lambda: monitor.rhythm.count >= FLOOD)
        assert monitor.rhythm.count == FLOOD
        assert monitor.latest.x == FLOOD - 1
        assert monitor._redraw.errors == ()
    finally:
        flooder.communicate(b"\n", timeout=DEADLINE)


@pytest.mark.parametrize("reliability", [ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE])
@pytest.mark.parametrize("durability", [DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL])
def test_the_monitor_follows_publishers_that_come_after_it(
    session: LabSession, reliability: ReliabilityPolicy, durability: DurabilityPolicy
) -> None:
    monitor = TopicMonitor(session, "/word", String)
    qos = QoSProfile(depth=10, reliability=reliability, durability=durability)

    class Talker(Node):
        def __init__(self) -> None:
            super().__init__("talker")
            self._publisher = self.create_publisher(String, "/word", qos)
            self.create_timer(0.02, lambda: self._publisher.publish(String(data="word")))

    session.run(Talker)
    until(lambda: monitor.rhythm.count >= 5)
    assert monitor.latest.data == "word"


def test_the_monitor_hears_what_was_kept_for_late_ones_once(session: LabSession) -> None:
    session.publish("/word", "kept")  # transient-local
    monitor = TopicMonitor(session, "/word")
    until(lambda: monitor.rhythm.count > 0)
    monitor._look_around()
    session.publish("/word", "new")
    until(lambda: monitor.latest.data == "new")
    assert monitor.rhythm.count == 2


def test_the_monitor_explains_its_silence(session: LabSession) -> None:
    session.publish("/word", "word")
    monitor = TopicMonitor(session, "/wrod", String)
    assert monitor.note == "No node publishes on /wrod. Did you mean /word?"
    other = TopicMonitor(session, "/pose", Twist)
    with other_context(session.domain_id) as (node, _):
        node.create_publisher(Pose, "/pose", 10)
        until(lambda: "geometry_msgs/msg/Pose there, not geometry_msgs/msg/Twist" in other.note)


def test_a_topic_of_another_type_is_refused_in_one_sentence(session: LabSession) -> None:
    session.publish("/word", "word")
    for make in (
        lambda: TopicMonitor(session, "/word", Twist),
        lambda: MessageForm(session, "/word", Twist),
        lambda: Teleop(session, topic="/word"),
    ):
        with pytest.raises(ValueError, match=r"/word carries std_msgs/msg/String in this kernel"):
            make()


# The form


def test_the_form_publishes_a_pose_with_its_covariance(session: LabSession) -> None:
    log = session.log("/initialpose", PoseWithCovarianceStamped)
    form = MessageForm(session, "/initialpose", PoseWithCovarianceStamped)
    covariance = ["0.0"] * 36
    covariance[0] = "0.25"
    values = {
        "header": {"frame_id": "map", "stamp": NOW},
        "pose": {"pose": {"position": {"x": "1", "y": "-2"}}, "covariance": covariance},
    }
    form.publish(values)
    message = log.wait_for(1, DEADLINE)[0].message
    assert (message.header.frame_id, message.pose.pose.position.x, message.pose.pose.position.y) == (
        "map",
        1.0,
        -2.0,
    )
    assert message.header.stamp.sec > 1_000_000_000
    assert list(message.pose.covariance) == [0.25, *[0.0] * 35]
    assert message.pose.pose.orientation.w == 1.0
    covariance[35] = "much"
    with pytest.raises(FormError, match=r"pose.covariance\[35\] takes a number"):
        form.publish(values)
    assert (form.sent, log.count) == (1, 1)


def test_the_form_publishes_arrays_of_messages(session: LabSession, monkeypatch: pytest.MonkeyPatch) -> None:
    log = session.log("/path", PoseArray)
    form = MessageForm(session, "/path", "geometry_msgs/msg/PoseArray")
    talk = Talk(form, monkeypatch)
    talk.tell(do="publish", number=1, values={"poses": [{"position": {"x": str(n)}} for n in range(3)]})
    assert talk.wait_for(lambda content: content["answer"] == 1)["problems"] == {}
    message = log.wait_for(1, DEADLINE)[0].message
    assert [pose.position.x for pose in message.poses] == [0.0, 1.0, 2.0]


def test_the_form_publishes_at_a_rate_and_stops(session: LabSession) -> None:
    log = session.log("/word", String)
    form = MessageForm(session, "/word", String)
    form.start(50, {"data": "again"})
    log.wait_for(5, DEADLINE)
    form.stop()
    session.publish("/word", "the end")
    log.wait_until(lambda message: message.data == "the end", DEADLINE)
    assert log.latest.message.data == "the end"
    assert log.count == form.sent + 1


# The pad


def nonzero(twist: Any) -> bool:
    return bool(twist.linear.x or twist.angular.z)


def hold(teleop: Teleop, monkeypatch: pytest.MonkeyPatch, *, linear: float = 1.0) -> Talk:
    """Begin to drive, as a browser does."""
    talk = Talk(teleop, monkeypatch)
    talk.tell(do="begin", hold="key")
    talk.tell(do="drive", hold="key", linear=linear, angular=0.5)
    return talk


def test_the_robot_stops_when_heartbeats_stay_away(
    session: LabSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = session.log("/cmd_vel", Twist)
    teleop = Teleop(session)
    until(lambda: teleop._publisher.get_subscription_count() > 0)
    talk = hold(teleop, monkeypatch)
    log.wait_until(nonzero, DEADLINE)
    talk.wait_for(lambda content: content.get("is_granted") is False)
    log.wait_until(lambda twist: not nonzero(twist), DEADLINE)
    # What comes late moves nothing, and nobody else is disturbed.
    talk.tell(do="drive", hold="key", linear=1.0, angular=0.0)
    session.publish("/cmd_vel", Twist(angular=Twist().angular.__class__(z=9.0)))
    log.wait_until(lambda twist: twist.angular.z == 9.0, DEADLINE)
    velocities = [(s.message.linear.x, s.message.angular.z) for s in log.samples()]
    assert velocities[-2:] == [(0.0, 0.0), (0.0, 9.0)]
    assert set(velocities[:-2]) == {(0.5, 0.5)}


def test_the_robot_is_driven_for_as_long_as_the_browser_says_so(
    session: LabSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = session.log("/cmd_vel", Twist)
    teleop = Teleop(session)
    until(lambda: teleop._publisher.get_subscription_count() > 0)
    talk = hold(teleop, monkeypatch)
    is_over = threading.Event()

    def beat() -> None:
        while not is_over.wait(0.05):
            talk.tell(do="drive", hold="key", linear=-1.0, angular=0.0)

    heart = threading.Thread(target=beat)
    heart.start()
    try:
        log.wait_for(15, DEADLINE)
        assert all(nonzero(sample.message) for sample in log.samples())
    finally:
        is_over.set()
        heart.join()
    talk.tell(do="end", hold="key")
    log.wait_until(lambda twist: not nonzero(twist), DEADLINE)
    assert not teleop.is_held


@pytest.mark.parametrize("end", ["the widget", "the session"])
def test_the_robot_stops_when_its_widget_closes(
    session: LabSession, monkeypatch: pytest.MonkeyPatch, end: str
) -> None:
    teleop = Teleop(session)
    heard: list[Any] = []
    with other_context(session.domain_id) as (node, spin_until):
        node.create_subscription(Twist, "/cmd_vel", heard.append, 10)
        spin_until(lambda: teleop._publisher.get_subscription_count() > 0)
        hold(teleop, monkeypatch)
        spin_until(lambda: any(map(nonzero, heard)))
        (teleop if end == "the widget" else session).close()
        spin_until(lambda: not nonzero(heard[-1]))
    assert teleop.is_closed


def test_nothing_is_published_while_nothing_is_held(session: LabSession) -> None:
    log = session.log("/cmd_vel", Twist)
    teleop = Teleop(session)
    until(lambda: teleop.listeners == 0 and teleop._publisher.get_subscription_count() > 0)
    session.publish("/cmd_vel", Twist())
    log.wait_for(1, DEADLINE)
    teleop.close()
    session.publish("/cmd_vel", Twist())
    log.wait_for(2, DEADLINE)
    assert log.count == 2
