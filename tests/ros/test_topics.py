"""A topic log counts, times, waits, and says why nothing came."""

from __future__ import annotations

import os
import sys
import threading
import time
from itertools import pairwise

import pytest
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int32, String

from deadlines import DEADLINE
from ros2lab.node_process import NodeProcess
from ros2lab.session import LabSession
from ros2lab.topics import TopicLog, find_type, type_name


class Talker(Node):
    """Publishes on demand, with the quality of service asked for."""

    qos = QoSProfile(depth=10)

    def __init__(self) -> None:
        super().__init__("talker")
        self.publisher_ = self.create_publisher(String, "/talk", self.qos)

    def say(self, *words: str) -> None:
        for word in words:
            self.publisher_.publish(String(data=word))


class LossyTalker(Talker):
    """Offers best effort."""

    qos = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)


class LatchedTalker(Talker):
    """Keeps its last message for late listeners."""

    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def heard(log: TopicLog) -> list[str]:
    return [sample.message.data for sample in log.samples()]


def listening(session: LabSession, talker: Talker, **options: object) -> TopicLog:
    """Return a log that has met the talker."""
    log = session.log("/talk", String, **options)  # type: ignore[arg-type]
    deadline = time.monotonic() + 5
    while not talker.publisher_.get_subscription_count():
        assert time.monotonic() < deadline, "the log and the talker did not meet"
        time.sleep(0.001)
    return log


def test_messages_come_in_order_with_their_times(session: LabSession) -> None:
    """Samples are oldest first, times only grow, and count tells of all."""
    talker = session.run(Talker)
    log = listening(session, talker)
    talker.say("a", "b", "c")
    samples = log.wait_for(3)
    assert [sample.message.data for sample in samples] == ["a", "b", "c"]
    assert all(earlier.time <= later.time for earlier, later in pairwise(samples))
    assert log.latest == samples[-1]
    assert log.samples(since=samples[0].time)[-1] == samples[-1]
    assert log.samples(since=samples[-1].time) == []


def test_the_ring_forgets_but_counts(session: LabSession) -> None:
    """Only the newest are held; the count tells of all."""
    talker = session.run(Talker)
    log = listening(session, talker, capacity=3)
    talker.say(*"abcdefgh")
    log.wait_for(8)
    assert heard(log) == ["f", "g", "h"]
    assert log.count == log.statistics().count == 8
    log.clear()
    assert log.count == 0
    assert log.latest is None


def test_waiting_for_a_certain_message(session: LabSession) -> None:
    """`wait_until` finds one that came before, and one that comes later."""
    talker = session.run(Talker)
    log = listening(session, talker, capacity=2)
    talker.say("past")
    log.wait_for(1)
    assert log.wait_until(lambda message: message.data == "past").message.data == "past"
    later = threading.Timer(0.05, talker.say, (*"uvwxyz", "future"))
    later.start()
    assert log.wait_until(lambda message: message.data == "future").message.data == "future"
    later.join()


def test_nothing_is_lost_at_full_speed(session: LabSession) -> None:
    """Five thousand messages, published as fast as Python can, all come."""
    talker = session.run(Talker)
    log = listening(session, talker)
    for start in range(0, 5000, 100):
        talker.say(*(str(n) for n in range(start, start + 100)))
        log.wait_for(start + 100)
    assert heard(log) == [str(n) for n in range(5000)]


def test_a_best_effort_publisher_is_heard(session: LabSession) -> None:
    """The log adapts to what publishers offer."""
    talker = session.run(LossyTalker)
    log = listening(session, talker)
    talker.say("x")
    log.wait_for(1)


def test_a_late_log_gets_what_a_latched_publisher_said(session: LabSession) -> None:
    """A transient-local publisher's last message reaches a log made afterwards."""
    talker = session.run(LatchedTalker)
    talker.say("early")
    assert session.log("/talk").wait_for(1)[0].message.data == "early"


@pytest.mark.parametrize(
    ("topic", "message_type", "qos", "words"),
    [
        ("/tolk", String, None, r"nothing came\. No node publishes on /tolk\. Did you mean /talk\?"),
        ("/nowhere/near", Twist, None, r"No node publishes on /nowhere/near\. Published are: /talk\."),
        (
            "/talk",
            String,
            QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL),
            r"The quality of service of talker does not fit: .*transient local",
        ),
        ("/talk", String, None, r"talker could be heard; perhaps it publishes less often"),
        ("/robot/talk", String, None, r"No node publishes on /robot/talk"),
    ],
)
def test_silence_is_explained(
    session: LabSession, topic: str, message_type: type, qos: QoSProfile | None, words: str
) -> None:
    """A wait that times out names the likely cause."""
    session.run(Talker)
    log = session.log(topic, message_type, qos=qos)
    with pytest.raises(TimeoutError, match=words):
        log.wait_for(1, timeout=0.3)
    with pytest.raises(TimeoutError, match=words):
        log.wait_until(lambda _: True, timeout=0.1)


COUNTER = """
import rclpy
from std_msgs.msg import Int32
rclpy.init()
node = rclpy.create_node("counter")
publisher = node.create_publisher(Int32, "/talk", 10)
node.create_timer(0.05, lambda: publisher.publish(Int32(data=1)))
rclpy.spin(node)
"""


def test_another_type_in_another_process_is_named(session: LabSession) -> None:
    """DDS keeps silent about publishers of another type; the explanation does not."""
    counter = NodeProcess("none", "counter", [sys.executable, "-c", COUNTER], os.environ)
    try:
        log = session.log("/talk", String)
        deadline = time.monotonic() + 10
        while not session.node.count_publishers("/talk"):
            assert time.monotonic() < deadline, counter.output
            time.sleep(0.005)
        with pytest.raises(
            TimeoutError, match="counter publishes std_msgs/msg/Int32 there, not std_msgs/msg/String"
        ):
            log.wait_for(1, timeout=0.2)
    finally:
        counter.stop()


def test_another_type_in_the_same_kernel_is_refused(session: LabSession) -> None:
    """DDS would say "invalid allocator"."""
    session.run(Talker)
    words = "/talk carries std_msgs/msg/String in this kernel, so it cannot carry std_msgs/msg/Int32 too"
    with pytest.raises(ValueError, match=words):
        session.log("/talk", Int32)
    with pytest.raises(ValueError, match=words):
        session.publish("/talk", Int32(data=1))


def test_a_topic_in_another_namespace_is_named(session: LabSession) -> None:
    """`/talk` for a node that stands in a namespace names the longer topic."""
    other = session.node.create_publisher(String, "/left/talks", 10)
    log = session.log("/talks", String)
    with pytest.raises(TimeoutError, match=r"Did you mean /left/talks\?"):
        log.wait_for(1, timeout=0.3)
    session.node.destroy_publisher(other)


def test_an_empty_domain_is_named(session: LabSession) -> None:
    """Where nobody says anything, the sentence says so."""
    with pytest.raises(TimeoutError, match="No other topic is published in this domain either"):
        session.log("/talk", String).wait_for(1, timeout=0.1)


def test_what_came_is_told(session: LabSession) -> None:
    """Too few is told apart from none."""
    talker = session.run(Talker)
    log = listening(session, talker)
    talker.say("only")
    with pytest.raises(TimeoutError, match=r"2 messages within 0\.2 s expected, 1 message came"):
        log.wait_for(2, timeout=0.2)


def test_closing_ends_the_wait_and_keeps_the_samples(session: LabSession) -> None:
    """A closed log keeps what it has, closes twice, and does not let anyone wait."""
    talker = session.run(Talker)
    log = listening(session, talker)
    talker.say("kept")
    log.wait_for(1)
    log.close()
    log.close()
    assert heard(log) == ["kept"]
    began = time.monotonic()
    with pytest.raises(TimeoutError, match="this log is closed"):
        log.wait_for(2, timeout=DEADLINE)
    assert time.monotonic() - began < 30


def test_a_new_log_of_the_same_topic_replaces(session: LabSession) -> None:
    """Running the log's cell again leaves one subscription."""
    talker = session.run(Talker)
    listening(session, talker)
    log = session.log("/talk", String)
    deadline = time.monotonic() + 5
    while session.node.count_subscribers("/talk") != 1:
        assert time.monotonic() < deadline
        time.sleep(0.001)
    talker.say("x")
    log.wait_for(1)


def test_a_log_is_a_table(session: LabSession) -> None:
    """Text and HTML show topic, type, count and the last message, escaped."""
    talker = session.run(Talker)
    log = listening(session, talker)
    talker.say("first", "<b>last</b>")
    log.wait_for(2)
    for words in ("/talk", "std_msgs/msg/String", "messages", " Hz", "largest gap"):
        assert words in str(log)
        assert words in log._repr_html_()
    assert "<b>last</b>" in str(log)
    assert "&lt;b&gt;last&lt;/b&gt;" in log._repr_html_()
    assert repr(log) == "TopicLog('/talk', std_msgs/msg/String, 2 messages)"


@pytest.mark.parametrize("name", ["std_msgs/msg/String", "std_msgs/String"])
def test_a_type_is_found_by_its_name(name: str) -> None:
    """Both ways of writing a type's name are understood."""
    assert find_type(name) is String
    assert type_name(String) == "std_msgs/msg/String"


@pytest.mark.parametrize("name", ["std_msgs/msg/Strong", "stdmsgs/msg/String", "String", "", "/"])
def test_an_unknown_type_is_one_sentence(name: str) -> None:
    """A name that is none is refused with what to look at."""
    with pytest.raises(ValueError, match="cannot be imported"):
        find_type(name)


def test_a_capacity_of_nothing_is_refused(session: LabSession) -> None:
    """A ring needs room for one."""
    with pytest.raises(ValueError, match="must be at least 1, not 0"):
        session.log("/talk", String, capacity=0)
