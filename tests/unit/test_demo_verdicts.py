"""What the demonstration says of driving follows from the velocities alone."""

from __future__ import annotations

import pytest

from ros2lab.grading.evidence import CommandSeen, Heard, Run
from ros2lab.verbs.demo import Expectation, is_obeyed, judge_driving, judge_lives

VELOCITY = "/cmd_vel"


def heard(*linear: float) -> dict[str, Heard]:
    """Velocities along x, 0.1 s apart."""
    values = [
        {"linear": {"x": x, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}} for x in linear
    ]
    times = [0.1 * number for number in range(len(linear))]
    found = Heard("geometry_msgs/msg/Twist", "/driver", times, values, len(linear))
    return {VELOCITY: found} if linear else {}


def run(*commands: tuple[str, tuple[float, ...]], before: tuple[float, ...] = (), ended: str = "") -> Run:
    """A run in which these velocities followed the commands."""
    return Run(
        programs=["robot"],
        setting="together",
        clock="real",
        nodes=["/driver"],
        publishes={},
        subscribes={},
        qos={},
        parameters={},
        quiet=heard(*before),
        commands=[CommandSeen(text, [], heard(*linear), {}, not ended) for text, linear in commands],
        ended={"robot": ended} if ended else {},
        stopped={},
        notes=[],
    )


def unmet(seen: Run) -> list[str]:
    """The expectations that were not met."""
    return [expectation.text for expectation in judge_driving(seen) if not expectation.is_met]


@pytest.mark.parametrize("came", [(True,), (False, False, True), (True, False, True)])
def test_a_robot_that_moves(came: tuple[bool, ...]) -> None:
    """It may take a moment, and pass zero."""
    assert is_obeyed(came, should_move=True, must_publish=True)


@pytest.mark.parametrize("came", [(), (False, False)])
def test_a_robot_that_does_not_move(came: tuple[bool, ...]) -> None:
    assert not is_obeyed(came, should_move=True, must_publish=True)


@pytest.mark.parametrize("came", [(False,), (True, True, False, False)])
def test_a_robot_that_stops(came: tuple[bool, ...]) -> None:
    """What was under way may still come; one zero is enough of those who publish only changes."""
    assert is_obeyed(came, should_move=False, must_publish=True)


@pytest.mark.parametrize("came", [(), (True, True), (True, False, True), (False, False, True)])
def test_a_robot_that_does_not_stop(came: tuple[bool, ...]) -> None:
    """Silence leaves the robot moving, and a zero among others does not stop it."""
    assert not is_obeyed(came, should_move=False, must_publish=True)


def test_a_right_drive() -> None:
    """Also of a robot that publishes only what changes; and nonsense changes nothing."""
    assert unmet(run(("start", (0.5, 0.5)), ("dance", (0.5,)), ("stop", (0.5, 0.0)), ("dance", (0.0,)))) == []
    assert unmet(run(("start", (0.5,)), ("dance", ()), ("stop", (0.0,)), ("dance", ()), ("reset", ()))) == []


def test_a_velocity_that_passes_zero_goes_on() -> None:
    """A sine is zero at times."""
    assert unmet(run(("start", (0.1,)), ("dance", (0.1, 0.0, -0.1)))) == []


def test_nonsense_that_changes_something() -> None:
    """Stopping and starting by nonsense are wrong; what was under way does not hide it."""
    stops = run(("start", (0.5,)), ("dance", (0.5, 0.0, 0.0, 0.0)))
    assert unmet(stops) == ["'dance' while it moves: it goes on so"]
    starts = run(("start", (0.5,)), ("stop", (0.0,)), ("", (0.0, 0.5, 0.5)))
    assert unmet(starts) == ["'' while it stands: it goes on so"]


def test_a_robot_that_drives_by_itself() -> None:
    assert unmet(run(before=(0.5, 0.0))) == ["before the first command the robot stands still"]
    assert unmet(run(before=(0.0,))) == unmet(run()) == []


def test_a_program_that_ends_is_named_with_its_last_words() -> None:
    (life,) = judge_lives(run(ended="Traceback\nValueError: 'dance'"))
    assert life == Expectation(
        "every node runs until Ctrl-C", False, "robot ended by itself: ValueError: 'dance'"
    )
