"""A look at the graph is complete: real processes that have just started, real DDS."""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import select
import signal
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from deadlines import DEADLINE
from portable_ros2 import graph, participants

NOBODY, EXAGGERATING = bytes(participants.PREFIX_LENGTH), b"x" * participants.PREFIX_LENGTH

NODE = """
import sys
import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node(sys.argv[1])
node.create_publisher(String, f"/from_{sys.argv[1]}", 10)
node.create_subscription(String, f"/to_{sys.argv[1]}", print, 10)
print("ready", flush=True)
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
"""


Start = Callable[..., list[subprocess.Popen[str]]]


@pytest.fixture
def start() -> Iterator[Start]:
    """Return a function that starts nodes with the given names, one process each, and waits for them."""
    started: list[subprocess.Popen[str]] = []

    def run(*names: str) -> list[subprocess.Popen[str]]:
        new = [
            subprocess.Popen([sys.executable, "-c", NODE, name], stdout=subprocess.PIPE, text=True)
            for name in names
        ]
        started.extend(new)
        for process in new:
            assert process.stdout is not None
            assert process.stdout.readline() == "ready\n"
        return new

    yield run
    for process in started:
        process.send_signal(signal.SIGCONT)
        process.kill()
        process.wait()
        assert process.stdout is not None
        process.stdout.close()


@pytest.fixture
def occupied(domain_id: int) -> Iterator[list[socket.socket]]:
    """Occupy two ports of a participant with a program that is none, and does not read."""
    port = participants.FIRST_PORT + participants.PORTS_PER_DOMAIN * domain_id + 40
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as first,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as second,
    ):
        first.bind(("", port))
        second.bind(("", port + 1))
        yield [first, second]


def listeners_at(port: int) -> list[participants.Listener]:
    """Return who listens at a port, none or one."""
    domain = (port - participants.FIRST_PORT) // participants.PORTS_PER_DOMAIN
    return [listener for listener in participants.listeners(domain) or () if listener.port == port]


def look(**options: Any) -> tuple[set[str], set[str]]:
    """Return the names of the nodes and of the topics that one look shows."""
    with graph.GraphNode(argparse.Namespace(**options)) as node:
        names = {name for name in node.get_node_names() if not name.startswith("_")}
        return names, {name for name, _ in node.get_topic_names_and_types()}


class TestGraphNode:
    """A node knows the graph once it is there."""

    def test_knows_everything_at_the_first_look(self, start: Start) -> None:
        names = {f"node_{number}" for number in range(5)}
        start(*names)
        topics = {f"/{way}_{name}" for way in ("from", "to") for name in names}
        for _ in range(5):
            assert look() == (names, topics | {"/rosout", "/parameter_events"})

    def test_knows_everything_where_other_machines_may_answer(
        self, start: Start, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
        start("a", "b")
        for _ in range(3):
            assert look()[0] == {"a", "b"}

    def test_is_alone_in_an_empty_domain(self) -> None:
        assert look() == (set(), {"/rosout", "/parameter_events"})

    def test_a_node_that_has_ended_is_not_there(self, start: Start) -> None:
        first, _ = start("first", "second")
        first.send_signal(signal.SIGINT)
        first.wait()
        assert look()[0] == {"second"}

    def test_does_not_wait_for_ever_for_a_stopped_node(self, start: Start) -> None:
        stopped, _ = start("stopped", "running")
        stopped.send_signal(signal.SIGSTOP)
        assert "running" in look()[0]

    def test_does_not_wait_for_ever_for_a_port_that_is_no_participants(
        self, start: Start, occupied: list[socket.socket]
    ) -> None:
        start("node")
        with subprocess.Popen(["sleep", "60"], pass_fds=[place.fileno() for place in occupied]) as foreign:
            for place in occupied:
                place.close()
            assert look()[0] == {"node"}
            foreign.kill()

    def test_has_its_own_names_in_order(self) -> None:
        with graph.GraphNode(argparse.Namespace(), name="_mine") as node:
            assert node.get_name() == "_mine"
            infos = node.get_publishers_info_by_topic("/rosout")
            assert [info.node_name for info in infos] == ["_mine"]

    @pytest.mark.parametrize("domain", ["abc", "-1", "233", "1.5"])
    def test_tells_a_wrong_domain(self, domain: str, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setenv("ROS_DOMAIN_ID", domain)
        with pytest.raises(RuntimeError, match=f"ROS_DOMAIN_ID={domain} is not a number from 0 to 232"):
            graph.GraphNode(argparse.Namespace())

    def test_no_spin_time_does_not_wait(self) -> None:
        assert look(spin_time=0.0)[0] == set()


class TestListeners:
    """What the kernel tells of participants."""

    @pytest.fixture
    def port(self, occupied: list[socket.socket]) -> int:
        """Return the first of the occupied ports."""
        return int(occupied[0].getsockname()[1])

    def test_a_participant_has_two_ports(self, occupied: list[socket.socket], port: int) -> None:
        assert [item.inode for item in listeners_at(port)] == [str(os.fstat(occupied[0].fileno()).st_ino)]
        assert listeners_at(port + 1) == []
        occupied[1].close()
        assert listeners_at(port) == []

    def test_another_domain_has_other_ports(self, port: int) -> None:
        assert port not in [item.port for item in participants.listeners(102) or ()]

    def test_what_has_come_is_read_or_not(self, occupied: list[socket.socket], port: int) -> None:
        occupied[1].sendto(b"hello", ("127.0.0.1", port))
        assert [listener.is_read for listener in listeners_at(port)] == [False]
        occupied[0].recv(9)
        assert [listener.is_read for listener in listeners_at(port)] == [True]

    def test_this_process_is_running(self, port: int) -> None:
        assert [participants.is_running(listener) for listener in listeners_at(port)] == [True]

    def test_a_stopped_process_is_not_running(self, start: Start, domain_id: int) -> None:
        (stopped,) = start("node")
        stopped.send_signal(signal.SIGSTOP)
        os.waitid(os.P_PID, stopped.pid, os.WSTOPPED)
        inodes = participants.sockets(stopped.pid)
        (listener,) = (item for item in participants.listeners(domain_id) or () if item.inode in inodes)
        assert not participants.is_running(listener)

    def test_a_process_that_is_gone_has_no_sockets(self) -> None:
        assert participants.sockets("999999999") == set()


class TestInquiry:
    """Participants answer."""

    def test_who_is_there_answers_what_it_has(self, start: Start, domain_id: int) -> None:
        start("node")
        with graph.GraphNode(argparse.Namespace()) as node:
            present = participants.listeners(domain_id) or []
            inodes = participants.sockets()
            (own,) = (item for item in present if item.inode in inodes)
            inquiry = participants.Inquiry(domain_id, own, reaches_out=False)
            deadline = time.monotonic() + DEADLINE
            try:
                inquiry.ask(present)
                while not any(map(inquiry.has_told, inquiry.participants)):
                    assert time.monotonic() < deadline
                    inquiry.listen()
            finally:
                inquiry.close()
            (answering,) = inquiry.participants
            topics = node.get_topic_names_and_types(no_demangle=True)
            known = {one for one in graph.known_endpoints(node, topics) if one.startswith(answering)}
        assert inquiry.endpoints == known
        assert len(inquiry.participants) == 1
        assert len(inquiry.answered) == 2  # our own, which is not asked, and the node's

    def test_a_message_that_is_not_right_is_survived(self, domain_id: int) -> None:
        """Anybody may send anything to a port."""
        letters = random.Random(1)
        own = participants.Listener(1, "", is_read=True)
        inquiry = participants.Inquiry(domain_id, own, reaches_out=False)
        asker = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        with contextlib.closing(inquiry), asker:
            asker.bind((participants.LOCALHOST, 0))
            address = (participants.LOCALHOST, inquiry._socket.getsockname()[1])
            for message in wrong_messages(letters):
                asker.sendto(message, address)
                assert select.select([inquiry._socket], [], [], DEADLINE)[0]
                inquiry.listen()
        assert not any(map(inquiry.has_told, [NOBODY, EXAGGERATING]))
        assert inquiry.endpoints == set()


def wrong_messages(letters: random.Random) -> Iterator[bytes]:
    """Yield RTPS messages with wrong lengths, wrong numbers and nonsense."""
    head = b"RTPS" + participants.VERSION + participants.VENDOR
    body = participants.WRITERS * 2 + struct.pack("<iIiI", 0, 1, 2**31 - 1, 0)  # announcements 1 to 2**63
    for length in range(24, 70):
        for kind in (participants.GAP, participants.HEARTBEAT, participants.DATA):
            header = struct.pack("<BBH", kind, 1, length)
            yield head + NOBODY + header + body + b"\xff" * (length - len(body))
    for _ in range(500):
        yield head + NOBODY + letters.randbytes(letters.randrange(90))
    yield head + EXAGGERATING + struct.pack("<BBH", participants.HEARTBEAT, 1, len(body)) + body


def test_a_process_shares_memory_as_long_as_it_has_a_node() -> None:
    """So a command may end at once when it has left the graph: nothing of it stays in /dev/shm."""
    program = """
import rclpy
from portable_ros2 import participants
rclpy.init()
node = rclpy.create_node("here")
print(participants.shares_memory())
node.destroy_node()
rclpy.shutdown()
print(participants.shares_memory())
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=DEADLINE
    )
    assert done.stdout.split() == ["True", "False"]


SWALLOWED = """
import argparse, contextlib, os, signal, time
from portable_ros2.graph import GraphNode
from std_msgs.msg import String
with GraphNode(argparse.Namespace(spin_time=0.1)) as node:
    with contextlib.suppress(KeyboardInterrupt):  # as Python does in a destructor
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(60)
    while node.context.ok():
        time.sleep(0.01)
    node.create_publisher(String, "/late", 1)
"""


def test_what_fails_after_ctrl_c_was_ended_by_ctrl_c() -> None:
    """Whoever still uses rclpy, which shuts down at once, gets an error of its own."""
    said = subprocess.run(
        [sys.executable, "-c", SWALLOWED], capture_output=True, text=True, timeout=DEADLINE, check=False
    )
    assert said.stderr.rstrip().endswith("KeyboardInterrupt")
