"""A private domain ends at this machine, gives back all that it has taken, and measures periods in one way."""

from __future__ import annotations

import os
import socket
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

import pytest
from rclpy.task import Future

from ros2lab import domain_lease, observed_domain
from ros2lab.domain_lease import discovery
from ros2lab.environment import lab_environment
from ros2lab.observed_domain import ObservedDomain
from ros2lab.rhythm import has_period

SETTINGS = ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS")
TICKS_WITH_ONE_BETWEEN = """
import rclpy
from std_msgs.msg import String

def tick():
    publisher.publish(String())
    if not between:
        between.append(node.create_timer(0.05, tell_once))

def tell_once():
    publisher.publish(String())
    between[0].cancel()

rclpy.init()
node, between = rclpy.create_node("ticking"), []
publisher = node.create_publisher(String, "/tick", 10)
node.create_timer(0.1, tick)
rclpy.spin(node)
"""
TELL = f"import os; print([os.environ.get(name) for name in {SETTINGS}])"


def free_domains() -> list[int]:
    """The domains that can be leased at this moment."""
    found = []
    for domain in domain_lease.DOMAINS:
        with socket.socket(socket.AF_UNIX) as lease:
            try:
                lease.bind(f"\0ros2lab-private-domain-{domain}")
            except OSError:
                continue
        found.append(domain)
    return found


@pytest.mark.parametrize("number", [None, 77])
def test_how_far_a_domain_reaches(monkeypatch: pytest.MonkeyPatch, number: int | None) -> None:
    """A leased one no further than this machine; that of the student as far as the environment says."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    monkeypatch.setenv("ROS_STATIC_PEERS", "192.0.2.1")
    seen: list[list[str | None]] = []

    class Context(observed_domain.Context):  # type: ignore[misc]
        def init(self, *args: Any, **options: Any) -> None:
            seen.append([os.environ.get(name) for name in SETTINGS[1:]])
            super().init(*args, **options)

    monkeypatch.setattr(observed_domain, "Context", Context)
    # Nobody is to be looked for outside of this machine by a test.
    monkeypatch.setattr(observed_domain, "Node", type("Node", (), {"__init__": _stop}))
    with pytest.raises(_StoppedError):
        ObservedDomain(number)
    assert seen == [["LOCALHOST", ""] if number is None else ["SUBNET", "192.0.2.1"]]
    assert os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "SUBNET"
    assert os.environ["ROS_STATIC_PEERS"] == "192.0.2.1"


class _StoppedError(Exception):
    pass


def _stop(*_: object, **__: object) -> None:
    raise _StoppedError


def test_programs_of_a_leased_domain_stay_in_it() -> None:
    environ = {**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET", "ROS_STATIC_PEERS": "192.0.2.1"}
    with ObservedDomain() as domain:
        program = domain.start("tell", [sys.executable, "-c", TELL], environ)
        program.wait(30)
        assert program.output.strip() == str([str(domain.number), "LOCALHOST", ""])


def test_a_domain_is_as_patient_as_its_programs_were_slow_to_start() -> None:
    with ObservedDomain() as domain:
        least = domain.patience
        assert not domain.wait_for_start(lambda: False, 0.1)
        assert domain.wait_for_start(lambda: True, 0.1)
        assert domain.patience == least
        begin = time.monotonic()
        assert domain.wait_for_start(lambda: time.monotonic() > begin + least, 10 * least)
        assert domain.patience >= 2 * least


@pytest.mark.parametrize("part", ["Context", "Node", "Listener"])
def test_nothing_is_kept_when_it_cannot_be_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, part: str
) -> None:
    """The lease, the folder, the context and the node are given back."""
    contexts, nodes = [], []

    class Context(observed_domain.Context):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__()
            contexts.append(self)

    class Node(observed_domain.Node):  # type: ignore[misc]
        def __init__(self, *args: Any, **options: Any) -> None:
            super().__init__(*args, **options)
            self.is_destroyed = False
            nodes.append(self)

        def destroy_node(self) -> None:
            self.is_destroyed = True
            super().destroy_node()

    monkeypatch.setattr(observed_domain, "Context", Context)
    monkeypatch.setattr(observed_domain, "Node", Node)
    monkeypatch.setattr(observed_domain, part, _stop)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(domain_lease, "DOMAINS", (213,))  # which nobody else leases
    with pytest.raises(_StoppedError):
        ObservedDomain()
    assert free_domains() == [213]
    assert not any(context.ok() for context in contexts)
    assert all(node.is_destroyed for node in nodes)
    assert list(tmp_path.iterdir()) == []


def test_a_domain_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """For as long as it may be that a check ends; then it is said that none is free."""
    monkeypatch.setattr(domain_lease, "DOMAINS", (212,))
    monkeypatch.setattr(domain_lease, "PATIENCE", 10.0)
    with socket.socket(socket.AF_UNIX) as first, socket.socket(socket.AF_UNIX) as second:
        assert domain_lease.leased(first) == 212
        with pytest.raises(domain_lease.NoDomainError, match="domains for checks on this machine are taken"):
            domain_lease.leased(second, until=time.monotonic() + 0.2)
        threading.Timer(0.3, first.close).start()
        assert domain_lease.leased(second) == 212


def test_who_leases_several_domains_waits_for_another_to_have_all_of_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(domain_lease, "PATIENCE", 0.2)
    monkeypatch.setattr(domain_lease, "TURN", "\0ros2lab-test-turn")
    monkeypatch.setattr(domain_lease, "DOMAINS", (211,))
    with domain_lease.in_turn():
        with pytest.raises(domain_lease.NoDomainError), domain_lease.in_turn():
            pass
        with socket.socket(socket.AF_UNIX) as lease:  # one alone needs no turn
            assert domain_lease.leased(lease) == 211
    with domain_lease.in_turn():
        pass


def test_discovery_is_as_it_was_afterwards(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_AUTOMATIC_DISCOVERY_RANGE")
    with discovery("OFF"):
        assert os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "OFF"
    assert "ROS_AUTOMATIC_DISCOVERY_RANGE" not in os.environ
    assert "ROS_STATIC_PEERS" not in os.environ


def test_a_message_between_two_of_a_timer_does_not_make_it_twice_as_fast() -> None:
    with ObservedDomain() as domain:
        command = [sys.executable, "-c", TICKS_WITH_ONE_BETWEEN, "--ros-args", "-p", "use_sim_time:=true"]
        domain.start("ticking", command, lab_environment())
        assert domain.wait_for_start(
            lambda: "/tick" in domain.published() and "/ticking" in domain.nodes(), 20
        )
        assert domain.all_answer()
        period = domain.period(domain.log("/tick", "std_msgs/msg/String"), 0.1)
        assert has_period(period, 0.1)


def test_time_without_a_turn_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is waited for has had to wait as well."""
    with ObservedDomain() as domain:
        turns: list[float] = []

        def listen_late(seconds: float) -> None:
            turns.append(seconds)
            time.sleep(0.1)

        monkeypatch.setattr(domain._listener, "listen", listen_late)
        assert domain.wait(lambda: len(turns) == 5, 0.1)
        assert not domain.wait(lambda: False, 0.1)


def test_who_has_not_answered_is_asked_again() -> None:
    """A service drops a response if it has not met the client's subscription in time."""
    answer: Future[str] = Future()
    answer.set_result("here")
    with ObservedDomain() as domain:
        domain.patience = 0.1
        lost: list[Future[str]] = [Future(), answer]
        assert domain._answers(lambda: lost.pop(0), lambda: answer) == ["here", "here"]
        assert domain._answers(lambda: answer, Future) == []
