"""The monitor, the form and the pad at a session without ROS, with the test as their browser."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import pytest
from geometry_msgs.msg import Twist
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from stand_in_session import StandInSession
from std_msgs.msg import Int8, String

from ros2lab.message_schema import FormError
from ros2lab.widgets import MessageForm, Teleop, TopicMonitor, message_form

RELIABLE = QoSProfile(depth=1)
LOSSY = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def session() -> Iterator[StandInSession]:
    session = StandInSession()
    yield session
    session.close()


class Browser:
    """What a widget sends, and what it is told; time stands still but for `wait`."""

    def __init__(self, widget: Any, monkeypatch: pytest.MonkeyPatch) -> None:
        self.widget = widget
        self.heard: list[dict[str, Any]] = []
        monkeypatch.setattr(widget, "send", lambda content, buffers=None: self.heard.append(content))
        self._now = time.monotonic()
        monkeypatch.setattr(time, "monotonic", lambda: self._now)

    def tell(self, **content: Any) -> None:
        self.widget._handle_custom_msg(content, [])

    def wait(self, seconds: float) -> None:
        self._now += seconds


# The monitor


@pytest.fixture
def monitor(session: StandInSession) -> TopicMonitor:
    monitor = TopicMonitor(session, "/topic")
    for job in (monitor._send_new, monitor._look_around):
        monitor._redraw.remove(job)  # the test says when it is a tick's turn
    return monitor


def publish_on(session: StandInSession, *offers: QoSProfile) -> None:
    session.node.publishers["/topic"] = list(offers)
    session.node.types["/topic"] = "std_msgs/msg/String"


def test_the_monitor_takes_the_type_when_it_is_published(
    monitor: TopicMonitor, session: StandInSession
) -> None:
    assert monitor.type_name == ""
    assert "No node publishes on /topic." in monitor.note
    publish_on(session, RELIABLE)
    monitor._look_around()
    assert monitor.type_name == "std_msgs/msg/String"
    session.node.receive("/topic", String(data="word"))
    monitor._look_around()
    assert monitor.note == ""
    assert monitor.latest == String(data="word")


def test_the_monitor_says_that_a_published_type_is_not_installed(
    monitor: TopicMonitor, session: StandInSession
) -> None:
    publish_on(session, RELIABLE)
    session.node.types["/topic"] = "no_msgs/msg/No"
    monitor._look_around()
    assert "'no_msgs/msg/No' cannot be imported" in monitor.note


def test_the_monitor_makes_a_tree_of_the_newest_message_only(
    monitor: TopicMonitor, session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    publish_on(session, RELIABLE)
    monitor._look_around()
    browser = Browser(monitor, monkeypatch)
    for n in range(1000):
        session.node.receive("/topic", String(data=str(n)))
        browser.wait(0.001)
    monitor._send_new()
    monitor._send_new()
    (content,) = browser.heard
    assert content["count"] == 1000
    assert content["rate"] == pytest.approx(1000)
    assert content["jitter"] == pytest.approx(0, abs=1e-6)
    assert content["size"] == 12  # 4 of CDR's header, 4 of the length, "999" and its end
    assert content["tree"]["children"] == [{"name": "data", "type": "string", "text": '"999"'}]


def test_a_paused_monitor_counts_and_sends_nothing_until_it_goes_on(
    monitor: TopicMonitor, session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    publish_on(session, RELIABLE)
    monitor._look_around()
    browser = Browser(monitor, monkeypatch)
    monitor.pause()
    session.node.receive("/topic", String(data="word"))
    monitor._send_new()
    assert browser.heard == []
    assert monitor.rhythm.count == 1
    monitor.resume()
    monitor._send_new()
    assert browser.heard[0]["count"] == 1


def test_a_page_that_comes_back_is_told_the_newest_message(
    monitor: TopicMonitor, session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    browser = Browser(monitor, monkeypatch)
    browser.tell(ask="message")
    assert (browser.heard[0]["is_whole"], browser.heard[0]["count"]) == (True, 0)
    assert "tree" not in browser.heard[0]


def test_the_monitor_follows_a_publisher_that_is_lossy(
    monitor: TopicMonitor, session: StandInSession
) -> None:
    publish_on(session, RELIABLE)
    monitor._look_around()
    first = monitor._subscription
    monitor._look_around()
    assert monitor._subscription is first
    publish_on(session, RELIABLE, LOSSY)
    monitor._look_around()
    assert monitor._subscription is not first
    assert monitor._qos.reliability == ReliabilityPolicy.BEST_EFFORT


def test_the_monitor_asks_for_what_was_kept_only_while_nothing_has_come(session: StandInSession) -> None:
    early, late = (TopicMonitor(session, f"/{name}", String) for name in ("early", "late"))
    session.node.receive("/late", String())
    for name, monitor in (("early", early), ("late", late)):
        session.node.publishers[f"/{name}"] = [KEPT]
        session.node.types[f"/{name}"] = "std_msgs/msg/String"
        monitor._look_around()
    assert early._qos.durability == DurabilityPolicy.TRANSIENT_LOCAL
    assert late._qos.durability == DurabilityPolicy.VOLATILE


def test_the_monitor_is_described_in_words(monitor: TopicMonitor, session: StandInSession) -> None:
    assert monitor.description == "Monitor of /topic: no message yet."
    publish_on(session, RELIABLE)
    monitor._look_around()
    session.node.receive("/topic", String(data="word"))
    assert monitor.description == "Monitor of /topic (std_msgs/msg/String): 1 message."
    assert any('data: "word"' in text.get_text() for text in monitor.still().texts)


# The form


def test_the_form_publishes_what_fits(session: StandInSession, monkeypatch: pytest.MonkeyPatch) -> None:
    form = MessageForm(session, "/topic", Twist)
    browser = Browser(form, monkeypatch)
    browser.tell(do="publish", number=7, values={"linear": {"x": "1"}})
    ((topic, message),) = session.published
    assert (topic, message.linear.x) == ("/topic", 1.0)
    assert browser.heard == [{"answer": 7, "problems": {}}]
    assert form.sent == 1
    assert form.message is message


def test_the_form_refuses_at_the_field_and_publishes_nothing(
    session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    form = MessageForm(session, "/topic", "std_msgs/msg/Int8")
    browser = Browser(form, monkeypatch)
    for action in ("publish", "start"):
        browser.tell(do=action, number=1, values={"data": "200"}, rate=5)
    says = "data takes a whole number from -128 to 127, not '200'."
    assert browser.heard == 2 * [{"answer": 1, "problems": {"data": says}}]
    browser.tell(do="start", number=2, values={"data": "1"}, rate=None)
    assert browser.heard[-1]["problems"] == {"": "The rate is a number in Hz, not None."}
    browser.tell(do="start", number=3, values={"data": "1"}, rate=1000)
    assert "from 0.1 to 100 Hz" in browser.heard[-1]["problems"][""]
    assert session.published == []
    assert form.publishing_rate == 0
    with pytest.raises(FormError, match="-128 to 127"):
        form.publish({"data": "200"})


def test_the_form_publishes_at_a_rate_until_it_is_stopped(
    session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    form = MessageForm(session, "/topic", Int8)
    jobs: list[Any] = []
    monkeypatch.setattr(form._redraw, "add", lambda job, rate: jobs.append((job, rate)))
    browser = Browser(form, monkeypatch)
    browser.tell(do="start", number=1, values={"data": "1"}, rate=20)
    assert (len(session.published), form.publishing_rate) == (1, 20.0)
    ((again, rate),) = jobs
    assert rate == 20.0
    again()
    browser.tell(do="publish", number=2, values={"data": "2"})
    again()
    assert [message.data for _, message in session.published] == [1, 1, 2, 2]
    browser.tell(do="stop")
    assert (form.publishing_rate, form.sent) == (0.0, 4)


def test_the_form_stops_when_its_page_is_not_heard_from_any_more(
    session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    form = MessageForm(session, "/topic", Int8)
    browser = Browser(form, monkeypatch)
    form.start(1.0)
    browser.wait(0.9 * message_form.MOST_ABSENCE)
    browser.tell(do="nothing")
    browser.wait(0.9 * message_form.MOST_ABSENCE)
    form._look_around()
    assert form.publishing_rate == 1.0
    browser.wait(0.2 * message_form.MOST_ABSENCE)
    form._look_around()
    assert form.publishing_rate == 0.0


def test_a_closed_form_publishes_nothing(session: StandInSession) -> None:
    form = MessageForm(session, "/topic", Int8)
    form.start(50.0)
    form.close()
    count = len(session.published)
    assert form.publishing_rate == 0.0
    form._handle_custom_msg({"do": "publish", "number": 1, "values": {}}, [])
    with pytest.raises(RuntimeError, match="closed; make a new one"):
        form.publish()
    assert len(session.published) == count


# The pad


@pytest.fixture
def teleop(session: StandInSession) -> Teleop:
    teleop = Teleop(session, linear_speed=0.5, angular_speed=2)
    for job in (teleop._drive, teleop._watch):
        teleop._clock.remove(job)  # the test says when it is a tick's turn
    return teleop


def velocities(session: StandInSession) -> list[tuple[float, float]]:
    return [(twist.linear.x, twist.angular.z) for twist in session.node.sent]


def test_the_pad_publishes_only_while_something_is_held_and_zero_at_the_end(
    teleop: Teleop, session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    browser = Browser(teleop, monkeypatch)
    teleop._drive()
    browser.tell(do="begin", hold="a")
    assert browser.heard == [{"hold": "a", "is_granted": True}]
    teleop._drive()
    assert velocities(session) == []
    browser.tell(do="drive", hold="a", linear=1, angular=0)
    assert teleop.is_held
    teleop._drive()
    browser.tell(do="drive", hold="a", linear=0.5, angular=-1)
    assert velocities(session) == 2 * [(0.5, 0.0)], "at 10 Hz, however often the browser speaks"
    teleop._drive()
    browser.tell(do="end", hold="a")
    teleop._drive()
    assert velocities(session)[2:] == [(0.25, -2.0), (0.0, 0.0)]
    assert (teleop.linear, teleop.angular) == (0.0, 0.0)
    assert not teleop.is_held


def test_a_hold_that_drove_nothing_publishes_nothing(
    teleop: Teleop, session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    browser = Browser(teleop, monkeypatch)
    browser.tell(do="begin", hold="a")
    browser.tell(do="end", hold="a")
    assert velocities(session) == []


def test_without_heartbeats_the_robot_stops_within_half_a_second(
    teleop: Teleop, session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    browser = Browser(teleop, monkeypatch)
    browser.tell(do="begin", hold="a")
    for _ in range(10):
        browser.tell(do="drive", hold="a", linear=1, angular=0)
        browser.wait(0.3)
        teleop._watch()
    assert velocities(session) == [(0.5, 0.0)]
    browser.wait(0.15)
    teleop._watch()
    assert velocities(session)[-1] == (0.0, 0.0)
    assert (browser.heard[-1]["hold"], browser.heard[-1]["is_granted"]) == ("a", False)


def test_what_waited_while_the_kernel_was_busy_moves_nothing(
    teleop: Teleop, session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    browser = Browser(teleop, monkeypatch)
    browser.tell(do="begin", hold="a")
    browser.tell(do="drive", hold="a", linear=1, angular=0)
    browser.wait(3.0)
    teleop._watch()
    for _ in range(30):
        browser.tell(do="drive", hold="a", linear=1, angular=0)
    teleop._drive()
    assert velocities(session) == [(0.5, 0.0), (0.0, 0.0)]


def test_a_second_page_takes_over_and_the_first_one_is_told(
    teleop: Teleop, session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    browser = Browser(teleop, monkeypatch)
    browser.tell(do="begin", hold="a")
    browser.tell(do="drive", hold="a", linear=1, angular=0)
    browser.tell(do="begin", hold="b")
    browser.tell(do="drive", hold="a", linear=1, angular=0)
    browser.tell(do="end", hold="a")
    browser.tell(do="drive", hold="b", linear=-1, angular=0)
    assert velocities(session) == [(0.5, 0.0), (0.0, 0.0), (-0.5, 0.0)]
    assert [(m["hold"], m["is_granted"]) for m in browser.heard] == [("a", True), ("a", False), ("b", True)]


@pytest.mark.parametrize("end", ["close", "stop", "session"])
def test_every_end_stops_the_robot(
    teleop: Teleop, session: StandInSession, monkeypatch: pytest.MonkeyPatch, end: str
) -> None:
    browser = Browser(teleop, monkeypatch)
    browser.tell(do="begin", hold="a")
    browser.tell(do="drive", hold="a", linear=1, angular=1)
    {"close": teleop.close, "stop": teleop.stop, "session": session.close}[end]()
    browser.tell(do="drive", hold="a", linear=1, angular=1)
    assert velocities(session) == [(0.5, 2.0), (0.0, 0.0)]


@pytest.mark.parametrize(
    ("asked", "velocity"),
    [
        ((3, -7), [(0.5, -2.0)]),
        ((float("nan"), float("inf")), [(0.0, 0.0)]),
        (("1", 0), []),
        ((None, None), []),
    ],
)
def test_what_a_browser_may_ask_for_is_limited(
    teleop: Teleop, session: StandInSession, monkeypatch: pytest.MonkeyPatch, asked: Any, velocity: list[Any]
) -> None:
    browser = Browser(teleop, monkeypatch)
    browser.tell(do="begin", hold="a")
    browser.tell(do="drive", hold="a", linear=asked[0], angular=asked[1])
    assert velocities(session) == velocity
    assert all(type(value) is float for pair in velocities(session) for value in pair)
