"""The node that drives the robot."""

import pytest
from geometry_msgs.msg import Twist
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from std_msgs.msg import String

from conftest import LATCHED, Bench
from robot_controller.command_subscriber import CommandSubscriber
from robot_controller.velocity_publisher import VelocityPublisher


class Drive:
    """What arrives on `/cmd_vel`, as (linear.x, angular.z)."""

    def __init__(self, bench: Bench, topic: str = "/cmd_vel") -> None:
        self._twists: list[Twist] = bench.hear(topic, Twist)

    @property
    def speeds(self) -> list[tuple[float, float]]:
        """Return all that came, oldest first."""
        return [(twist.linear.x, twist.angular.z) for twist in self._twists]

    @property
    def last(self) -> tuple[float, float] | None:
        """Return the last that came."""
        return self.speeds[-1] if self._twists else None


def test_it_publishes_every_tenth_of_a_second(bench: Bench) -> None:
    """By a simulated clock at 0.1, 0.2, ... s, not in between; zero while the state is unknown."""
    drive = Drive(bench)
    node = bench.add(VelocityPublisher, use_sim_time=True)
    bench.until(lambda: bench.listener.count_publishers("/cmd_vel") == 1, "the publisher is known")
    for hundredths in range(0, 101, 5):
        bench.set_time(node, hundredths / 100)
        expected = hundredths // 10
        bench.until(
            lambda n=expected: len(drive.speeds) >= n,
            f"{expected} messages by {hundredths} hundredths",
        )
        assert len(drive.speeds) == expected
    assert set(drive.speeds) == {(0.0, 0.0)}


def test_it_reacts_at_once(bench: Bench) -> None:
    """A change of state is answered by one message, also while time stands still; else none."""
    drive = Drive(bench)
    bench.add(VelocityPublisher, use_sim_time=True)
    states = bench.speaker("/robot/state", LATCHED)
    expected = []
    for state, speed in [
        ("running", 0.5),
        ("running", None),
        ("stopped", 0.0),
        ("running", 0.5),
        ("idle", 0.0),
    ]:
        states.publish(String(data=state))
        if speed is not None:
            expected.append((speed, 0.4 * speed))
            bench.until(lambda: len(drive.speeds) >= len(expected), f"an answer to {state}")
    assert drive.speeds == expected


def test_new_speeds_hold_while_running(bench: Bench) -> None:
    """The speeds are parameters, at start-up and at run time."""
    drive = Drive(bench)
    node = bench.add(VelocityPublisher, period=0.02, linear_speed=1.5, angular_speed=-1.0)
    bench.speaker("/robot/state", LATCHED).publish(String(data="running"))
    bench.until(lambda: drive.last == (1.5, -1.0), "the speeds given at start-up")
    node.set_parameters(
        [Parameter("linear_speed", value=0.25), Parameter("angular_speed", value=0.75)],
    )
    bench.until(lambda: drive.last == (0.25, 0.75), "the speeds given at run time")


def test_a_new_period_holds_at_once(bench: Bench) -> None:
    """The next message comes one new period after the change."""
    drive = Drive(bench)
    node = bench.add(VelocityPublisher, use_sim_time=True, period=10.0)
    bench.until(lambda: bench.listener.count_publishers("/cmd_vel") == 1, "the publisher is known")
    assert node.set_parameters([Parameter("period", value=0.5)])[0].successful
    for seconds, expected in ((0.4, 0), (0.5, 1), (0.9, 1), (1.0, 2)):
        bench.set_time(node, seconds)
        bench.until(
            lambda n=expected: len(drive.speeds) >= n,
            f"{expected} messages by {seconds} s",
        )
        assert len(drive.speeds) == expected


def test_it_stands_still_when_nobody_tells_the_state(bench: Bench) -> None:
    """The robot stops when the command node goes, until another speaks, and at a wrong word."""
    drive = Drive(bench)
    bench.add(VelocityPublisher, use_sim_time=True)
    commander = bench.add(CommandSubscriber)
    bench.speaker("/robot/command").publish(String(data="start"))
    bench.until(lambda: drive.last == (0.5, 0.2), "the robot drives")
    bench.remove(commander)
    bench.until(lambda: drive.last == (0.0, 0.0), "it stops with the command node gone")
    expected = drive.speeds
    states = bench.speaker("/robot/state", LATCHED)
    for state, speed in [("stopped", 0.0), ("running", 0.5), ("flying", 0.0)]:
        states.publish(String(data=state))
        expected.append((speed, 0.4 * speed))
        bench.until(lambda: len(drive.speeds) >= len(expected), f"an answer to {state}")
    assert drive.speeds == expected


def test_a_late_node_drives(bench: Bench) -> None:
    """A node that starts while the robot runs drives without a further command."""
    states = bench.hear_words("/robot/state")
    bench.add(CommandSubscriber)
    bench.speaker("/robot/command").publish(String(data="start"))
    bench.until(lambda: states[-1:] == ["running"], "the robot runs")
    drive = Drive(bench)
    bench.add(VelocityPublisher)
    bench.until(lambda: drive.last == (0.5, 0.2), "the late node drives")


def test_its_last_word_is_zero(bench: Bench) -> None:
    """A node that is destroyed, as in a notebook, publishes exactly one zero at its end."""
    drive = Drive(bench)
    node = bench.add(VelocityPublisher, use_sim_time=True)
    bench.speaker("/robot/state", LATCHED).publish(String(data="running"))
    bench.until(lambda: drive.last == (0.5, 0.2), "the robot drives")
    bench.remove(node)
    bench.until(lambda: drive.last == (0.0, 0.0), "a zero at the end")
    assert drive.speeds == [(0.5, 0.2), (0.0, 0.0)]


def test_nothing_moves_it_after_its_last_word(
    bench: Bench,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Neither the timer nor a new state, though another thread (the wait) still spins the node."""
    drive = Drive(bench)
    node = bench.add(VelocityPublisher, period=0.01)
    states = bench.speaker("/robot/state", LATCHED)
    states.publish(String(data="running"))
    bench.until(lambda: drive.last == (0.5, 0.2), "the robot drives")
    ticks: list[None] = []

    def spin_meanwhile(*_: object) -> None:
        states.publish(String(data="idle"))
        states.publish(String(data="running"))
        bench.listener.create_timer(0.01, lambda: ticks.append(None))
        bench.until(lambda: len(ticks) >= 10 and drive.last == (0.0, 0.0), "some time passes")

    monkeypatch.setattr(Publisher, "wait_for_all_acked", spin_meanwhile)
    node.destroy_node()
    driven = drive.speeds[drive.speeds.index((0.5, 0.2)) :]
    assert driven == [(0.5, 0.2)] * (len(driven) - 1) + [(0.0, 0.0)]


def test_a_namespace_moves_the_topics(bench: Bench) -> None:
    """The topics are relative."""
    drive = Drive(bench, "/anna/cmd_vel")
    bench.add(VelocityPublisher, "-r", "__ns:=/anna")
    bench.speaker("/anna/robot/state", LATCHED).publish(String(data="running"))
    bench.until(lambda: drive.last == (0.5, 0.2), "the node in /anna drives there")
