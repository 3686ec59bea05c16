"""Programs that use one topic with two types, watched for real: each type is listened to, and commands reach a node there."""

from __future__ import annotations

import contextlib
import math
import sys
from collections.abc import Iterator
from types import SimpleNamespace

import pytest
from rclpy.node import Node
from std_msgs.msg import String

from ros2lab.grading.sandbox.worlds import World
from ros2lab.grading.watching import ends, observe
from ros2lab.grading.watching.job import Job, Program
from ros2lab.grading.watching.observe import SHOWN, Observer
from ros2lab.grading.watching.participants import Participants
from ros2lab.observed_domain import TEXTS, ObservedDomain

BEGIN = """
import rclpy
from geometry_msgs.msg import Twist
from std_msgs.msg import String
rclpy.init()
"""
PROGRAMS = {
    "velocities": """
node = rclpy.create_node("velocities")
publisher = node.create_publisher(Twist, "/cmd_vel", 10)
node.create_timer(0.5, lambda: publisher.publish(Twist()))
rclpy.spin(node)
""",
    "texts": """
node = rclpy.create_node("texts")
publisher = node.create_publisher(String, "/cmd_vel", 10)
node.create_timer(0.5, lambda: publisher.publish(String(data="well")))
rclpy.spin(node)
""",
    "commands": """
node = rclpy.create_node("commands")
node.create_subscription(String, "/cmd_vel", lambda text: node.get_logger().info(f"I obey {text.data}"), 10)
rclpy.spin(node)
""",
}


@pytest.fixture(scope="module")
def observer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Observer]:
    folder = tmp_path_factory.mktemp("programs")
    for name, source in PROGRAMS.items():
        (folder / f"{name}.py").write_text(BEGIN + source)
    with (
        World(folder, shown=SHOWN) as world,
        Observer(world, rooms=observe.AT_ONCE, seconds=math.inf) as observer,
    ):
        yield observer


def test_a_participant_for_another_type_is_waited_for_until_it_has_met_the_publishers(
    domain_id: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    with (
        ObservedDomain(domain_id) as domain,
        contextlib.closing(Participants(domain.node, domain.node.context, domain_id)) as participants,
    ):
        assert participants.holding("/spoken", TEXTS) is domain.node
        other = participants.holding("/spoken", "std_msgs/msg/Int32")
        assert not participants.lags()
        publisher = domain.node.create_publisher(String, "/spoken", 1)
        assert domain.wait(lambda: not participants.lags())
        publishers = ends.publishers

        def unmet(node: Node, topic: str) -> list[SimpleNamespace]:
            return [] if node is other else publishers(node, topic)  # as before it has met them

        monkeypatch.setattr(ends, "publishers", unmet)
        assert participants.lags()
        participants.give_up()
        assert not participants.lags()
        second = domain.node.create_publisher(String, "/spoken", 1)
        assert domain.wait(participants.lags)  # for another one
        for each in (publisher, second):
            domain.node.destroy_publisher(each)
        assert domain.wait(lambda: not participants.lags())


@pytest.mark.parametrize(
    "names",
    [("velocities", "commands"), ("commands", "velocities"), ("texts", "velocities"), tuple(PROGRAMS)],
    ids="-".join,
)
def test_the_type_that_is_asked_for_is_heard_beside_another_one(
    observer: Observer, names: tuple[str, ...]
) -> None:
    programs = [Program(name, [sys.executable, f"/submission/{name}.py"]) for name in names]
    (run,) = observer.watch([Job.together(programs)])
    assert [note for note in run.notes if "not heard" in note or "failed" in note] == []
    assert run.torn == {"/cmd_vel": ["geometry_msgs/msg/Twist", "std_msgs/msg/String"]}
    assert run.quiet["/cmd_vel"].type_name == "geometry_msgs/msg/Twist"
    assert run.quiet["/cmd_vel"].node == "/velocities"
    assert run.clock == "stepped", run.notes
    if "commands" in names:
        told = {command.text: [line for _, line in command.log] for command in run.commands}
        assert run.commanded == "/cmd_vel"
        assert "I obey stop" in told["stop"]
