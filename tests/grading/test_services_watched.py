"""Programs with services, and topics that come once or on a change, are watched in the sandbox: what is seen of each."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator

import pytest

from ros2lab import assignments
from ros2lab.assignments import Assignment, Part
from ros2lab.grading.evidence import Run
from ros2lab.grading.judging.player import Player
from ros2lab.grading.judging.players import Case
from ros2lab.grading.questions.publisher import comes_when_it_should
from ros2lab.grading.sandbox.worlds import World
from ros2lab.grading.watching.job import Job, Program
from ros2lab.grading.watching.observe import SHOWN, Observer

ASSIGNMENT = """schema: 1
title: A door
package: {name: door}
parts:
  lock:
    provides: /door/lock
    type: std_srvs/srv/SetBool
    requests:
      - {request: {data: true}, response: {success: true}}
      - {request: {data: true}, response: {success: false}}
      - {request: {data: false}, response: {success: true}}
  state: {publishes: /door/state, type: std_msgs/msg/Bool, when: change}
  maker: {publishes: /door/maker, type: std_msgs/msg/String, when: once}
"""
BEGIN = """
import time
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool
rclpy.init()
node = rclpy.create_node("door")
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
state = node.create_publisher(Bool, "/door/state", 10)
maker = node.create_publisher(String, "/door/maker", latched)
is_locked = False
def lock(request, response):
    global is_locked
    response.success = request.data != is_locked
    is_locked = request.data
    if response.success:
        state.publish(Bool(data=is_locked))
    return response
"""
# Each with the levels of the state and of the maker.
PROGRAMS = {
    "right": ("right right", 'maker.publish(String(data="Ada"))'),
    "tells of each request": (
        "too_often right",
        """
maker.publish(String(data="Ada"))
whole = lock
def lock(request, response):
    response = whole(request, response)
    if not response.success:
        state.publish(Bool(data=is_locked))
    return response
""",
    ),
    "by time": (
        "too_often too_often",
        """
node.create_timer(1.0, lambda: state.publish(Bool(data=is_locked)))
node.create_timer(1.0, lambda: maker.publish(String(data="Ada")))
""",
    ),
    "nothing": (
        "silent silent",
        """
def lock(request, response):
    response.success = request.data
    return response
""",
    ),
}
END = """
node.create_service(SetBool, "/door/lock", lock)
rclpy.spin(node)
"""


@pytest.fixture(scope="module")
def door(tmp_path_factory: pytest.TempPathFactory) -> Assignment:
    folder = tmp_path_factory.mktemp("door")
    (folder / "assignment.yaml").write_text(ASSIGNMENT)
    return assignments.load(folder)


@pytest.fixture(scope="module")
def runs(door: Assignment, tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Run]]:
    folder = tmp_path_factory.mktemp("programs")
    programs = []
    for name, (_, source) in PROGRAMS.items():
        file = f"{name.replace(' ', '_')}.py"
        (folder / file).write_text(BEGIN + source + END)
        programs.append(Program(name, [sys.executable, f"/submission/{file}"]))
    with World(folder, shown=SHOWN) as world, Observer(world, door, seconds=math.inf) as observer:
        found = observer.watch([Job.alone(program) for program in programs])
        yield dict(zip(PROGRAMS, found, strict=True))


class Seen(Case):
    """A case of which nothing but one run is known."""

    def __init__(self, assignment: Assignment, run: Run) -> None:
        self.assignment = assignment
        self._run = run

    def whole(self, part: Part) -> Player:
        return Player(
            part, "right", part.topic, "/door", (part.type_name,), 0, self._run, self._run.programs[0]
        )


@pytest.mark.parametrize("name", PROGRAMS)
def test_what_comes_on_an_occasion(door: Assignment, runs: dict[str, Run], name: str) -> None:
    case = Seen(door, runs[name])
    parts = (door.parts["state"], door.parts["maker"])
    found = [comes_when_it_should(case, part).level for part in parts]
    assert " ".join(found) == PROGRAMS[name][0], runs[name]


def test_each_request_is_made_in_its_order_and_the_first_one_again(runs: dict[str, Run]) -> None:
    for name, run in runs.items():
        calls = run.calls
        assert [call.request["data"] for call in calls] == [True, True, False, True, True, True], name
        assert [call.is_repeated for call in calls] == [False] * 3 + [True] * 3, name
        assert all(call.response is not None and call.is_alive for call in calls), name
        assert run.services == {"/door/lock": {"/door": ["std_srvs/srv/SetBool"]}}, name


def test_what_follows_a_request_is_known_by_it(runs: dict[str, Run]) -> None:
    heard = [call.topics.get("/door/state") for call in runs["right"].calls]
    values = [[value["data"] for value in topic.values] if topic else [] for topic in heard]
    assert values == [[True], [], [False], [True], [], []]
