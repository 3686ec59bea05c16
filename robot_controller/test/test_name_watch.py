"""A node that is started twice."""

import pytest
from rclpy.node import Node

from conftest import Bench
from robot_controller import name_watch
from robot_controller.command_subscriber import CommandSubscriber
from robot_controller.status_publisher import StatusPublisher
from robot_controller.velocity_publisher import VelocityPublisher


@pytest.mark.parametrize("node_class", [StatusPublisher, CommandSubscriber, VelocityPublisher])
def test_a_second_node_of_the_same_name_is_named(
    bench: Bench,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    node_class: type[Node],
) -> None:
    """Both say it once, and the one left says when it is over; another namespace is no matter."""
    monkeypatch.setattr(name_watch, "LOOK_PERIOD", 0.02)
    output = ""

    def count(text: str) -> int:
        # From stderr: with two nodes of one name in one process, /rosout loses the lines of
        # the one that stays.
        nonlocal output
        output += capfd.readouterr().err
        return output.count(text)

    first = bench.add(node_class)
    bench.add(node_class, "-r", "__ns:=/anna")
    second = bench.add(node_class)
    warning = f"Another node is named /{first.get_name()} too"
    bench.until(lambda: count(warning) >= 2, "both warn")
    bench.remove(second)
    over = f"This is the only node named /{first.get_name()} again"
    bench.until(lambda: count(over) == 1, "it ends")
    assert count(warning) == 2
    assert count("named /anna") == 0
