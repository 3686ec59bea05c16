"""The node that tells how the robot is."""

import pytest
from rclpy.parameter import Parameter
from std_msgs.msg import String

from conftest import LATCHED, Bench
from robot_controller import state_topic
from robot_controller.robot_state import State
from robot_controller.status_line import parse_status
from robot_controller.status_publisher import StatusPublisher

PATIENCE = 0.05  # s


def test_it_publishes_every_two_seconds(bench: Bench) -> None:
    """With a simulated clock: at 2, 4 and 6 s, and not in between."""
    lines = bench.hear_words("/robot/status")
    node = bench.add(StatusPublisher, use_sim_time=True)
    count = bench.listener.count_publishers
    bench.until(lambda: count("/robot/status") == 1, "the publisher is known")
    counts = {}
    for tenths in range(0, 65):
        bench.set_time(node, tenths / 10)
        counts[tenths] = node._count
    assert counts == {tenths: tenths // 20 for tenths in range(0, 65)}
    bench.until(lambda: len(lines) >= 3, "the three lines arrive")
    assert [parse_status(line).count for line in lines] == [1, 2, 3]


def test_a_new_period_holds_at_once(bench: Bench) -> None:
    """The next message comes one new period after the change, whatever was left of the old one."""
    node = bench.add(StatusPublisher, use_sim_time=True, period=1000.0)
    bench.set_time(node, 10.0)
    assert node.set_parameters([Parameter("period", value=0.5)])[0].successful
    counts = []
    for seconds in (10.4, 10.5, 10.9, 11.0):
        bench.set_time(node, seconds)
        counts.append(node._count)
    assert counts == [0, 1, 1, 2]
    assert node.set_parameters([Parameter("period", value=1000.0)])[0].successful
    bench.set_time(node, 1010.9)
    assert node._count == 2, "the old timer still runs"


def test_it_tells_the_state(bench: Bench) -> None:
    """The line has the state that was heard last, and `unknown` before."""
    lines = bench.hear_words("/robot/status")
    bench.add(StatusPublisher, period=0.02)
    bench.until(lambda: bool(lines), "a first line")
    assert lines[0].startswith("state=unknown uptime_s=")
    states = bench.speaker("/robot/state", LATCHED)
    for state in ("running", "stopped", "idle"):
        states.publish(String(data=state))
        bench.until(
            lambda s=state: parse_status(lines[-1]).state is State(s),
            f"the line says {state}",
        )
    times = [parse_status(line).uptime for line in lines]
    assert times == sorted(times)
    assert times[0] >= 0.0


def test_missing_doubled_and_lost_state_is_named(
    bench: Bench,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The log says once that nobody publishes the state, that one does, two, one, and nobody."""
    monkeypatch.setattr(state_topic, "PATIENCE", PATIENCE)
    lines = bench.hear_log()
    statuses = bench.hear_words("/robot/status")
    bench.add(StatusPublisher, period=PATIENCE)
    bench.until(
        lambda: _has(lines, "WARN", "Nobody publishes /robot/state: is command_subscriber"),
        "missing",
    )
    bench.until(lambda: len(statuses) > 5, "it goes on for some time without the state")
    first = bench.speaker("/robot/state", LATCHED)
    bench.until(lambda: _has(lines, "INFO", "/robot/state has a publisher"), "it came")
    second = bench.speaker("/robot/state", LATCHED)
    bench.until(lambda: _has(lines, "WARN", "/robot/state has 2 publishers"), "it came twice")
    bench.listener.destroy_publisher(first)
    bench.until(lambda: _has(lines, "INFO", "/robot/state has a publisher"), "one of the two went")
    bench.listener.destroy_publisher(second)
    bench.until(lambda: _has(lines, "WARN", "Nobody publishes /robot/state any more"), "it went")
    assert len(lines) == 5


def _has(lines: list[str], level: str, text: str) -> bool:
    return bool(lines) and lines[-1].startswith(level) and text in lines[-1]
