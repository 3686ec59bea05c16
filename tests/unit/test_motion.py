"""How a robot on two wheels moves."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from ros2lab import motion
from ros2lab.motion import FARTHEST, Command, DrivenPath, Pose, moved


def in_small_steps(pose: Pose, linear: float, angular: float, duration: float, steps: int = 200_000) -> Pose:
    """Integrate with the midpoint rule, by other means than what is tested."""
    headings = pose.heading + angular * duration * (np.arange(steps) + 0.5) / steps
    step = linear * duration / steps
    return Pose(
        pose.x + step * float(np.cos(headings).sum()),
        pose.y + step * float(np.sin(headings).sum()),
        pose.heading + angular * duration,
    )


def test_a_turn_without_end_is_no_heading() -> None:
    path = DrivenPath(Pose(), 0.0, hold=1.0)
    path.drive([Command(0.0, 0.5, 1e308), Command(0.5, 0.5, 0.5)], 1.0)
    assert math.degrees(path.pose.heading) == pytest.approx(math.degrees(0.25))


@pytest.mark.parametrize("linear", [0.5, -1.3, 0.0])
@pytest.mark.parametrize("angular", [0.0, 1e-12, 0.2, -3.0])
def test_an_arc_is_exact(linear: float, angular: float) -> None:
    start = Pose(1.0, -2.0, 0.7)
    assert moved(start, linear, angular, 4.0) == pytest.approx(in_small_steps(start, linear, angular, 4.0))


def test_a_full_circle_ends_where_it_began() -> None:
    end = moved(Pose(), 0.5, 0.2, 2 * math.pi / 0.2)
    assert end[:2] == pytest.approx((0, 0), abs=1e-12)
    far = moved(Pose(), 0.5, 0.2, math.pi / 0.2)
    assert far[:2] == pytest.approx((0, 2 * 0.5 / 0.2), abs=1e-12), "the diameter is twice the radius v/w"


@pytest.mark.parametrize("looks", [1, 7, 400])
def test_the_way_does_not_depend_on_how_often_somebody_looks(looks: int) -> None:
    path = DrivenPath(Pose(), 0.0, hold=1.0)
    commands = [Command(0.5 + 0.1 * n, 0.5, 0.3 * (n % 3)) for n in range(30)]
    times = [5.0 * number / looks for number in range(looks + 1)]
    for begin, end in itertools.pairwise(times):
        path.drive([command for command in commands if begin < command.time <= end], end)
    whole = DrivenPath(Pose(), 0.0, hold=1.0)
    whole.drive(commands, 5.0)
    assert path.pose == pytest.approx(whole.pose)


def test_a_square_has_four_corners() -> None:
    path = DrivenPath(Pose(), 0.0, hold=10.0)
    for side in range(4):
        path.drive([Command(3.0 * side, 0.5, 0.0), Command(3.0 * side + 2, 0.0, math.pi / 2)], 3.0 * side + 3)
    assert path.pose == pytest.approx((0, 0, 2 * math.pi), abs=1e-9)
    corners = [(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)]
    np.testing.assert_allclose(path.vertices, corners, atol=1e-9)


def test_the_vertices_of_a_circle_lie_on_it_and_close_together() -> None:
    path = DrivenPath(Pose(), 0.0, hold=1.0)
    for number in range(800):
        path.drive([Command(0.05 * number, 0.5, 0.2)] if number % 2 else [], 0.05 * number)
    x, y = np.array([*path.vertices, *path.ahead, path.pose[:2]]).T
    np.testing.assert_allclose(np.hypot(x, y - 2.5), 2.5)
    assert np.hypot(np.diff(x), np.diff(y)).max() < 0.3


def test_a_robot_stops_that_is_not_told_to_go_on() -> None:
    path = DrivenPath(Pose(), 0.0, hold=1.0)
    path.drive([Command(2.0, 0.5, 0.0)], 2.5)
    assert path.command[1:] == (0.5, 0.0)
    path.drive([], 60.0)
    assert path.pose == pytest.approx((0.5, 0, 0))
    assert path.command[1:] == (0.0, 0.0)


def test_a_command_that_becomes_known_late_counts_from_its_own_time() -> None:
    path = DrivenPath(Pose(), 0.0, hold=1.0)
    path.drive([Command(0.0, 1.0, 0.0)], 0.6)
    assert path.pose.x == pytest.approx(0.6)
    path.drive([Command(0.5, 0.0, 0.0)], 0.8)
    assert path.pose.x == pytest.approx(0.5)


def test_a_command_that_becomes_known_after_the_robot_has_stopped_counts_too() -> None:
    path = DrivenPath(Pose(), 0.0, hold=1.0)
    path.drive([Command(0.0, 1.0, 0.0)], 1.1)
    assert path.command[1:] == (0.0, 0.0)
    path.drive([Command(0.9, 1.0, 0.0)], 1.4)
    assert path.pose.x == pytest.approx(1.4)


def random_commands(random: np.random.Generator) -> list[Command]:
    """Return commands over some 20 s: some repeat themselves, some come after the robot has stopped."""
    times = np.cumsum(random.choice([0.001, 0.1, 0.5, 2.5], size=40))
    choices = random.choice([0.0, 0.5, -0.3, 2.0], size=(40, 2))
    commands = [Command(float(time), *map(float, pair)) for time, pair in zip(times, choices, strict=True)]
    return [
        command._replace(linear=before.linear, angular=before.angular) if random.random() < 0.4 else command
        for before, command in itertools.pairwise([Command(0.0, 0.5, 0.0), *commands])
    ]


@pytest.mark.parametrize("seed", range(30))
def test_commands_lead_the_same_way_however_late_they_become_known(seed: int) -> None:
    """To the last bit: in any portions, each looked at any time, also after the next ones have come."""
    random = np.random.default_rng(seed)
    commands = random_commands(random)
    end = commands[-1].time + 0.4
    whole = DrivenPath(Pose(), 0.0, hold=1.0)
    whole.drive(commands, end)
    path = DrivenPath(Pose(), 0.0, hold=1.0)
    known, looked = 0, 0.0
    while known < len(commands):
        until = known + int(random.integers(0, 5))
        newest = commands[min(until, len(commands)) - 1].time if until else 0.0
        looked = max(looked, newest) + float(random.choice([0.0, 0.02, 0.6, 3.0]))
        path.drive(commands[known:until], looked)
        known = until
    path.drive([], end)
    assert path.pose == whole.pose
    assert path.command == whole.command
    assert (path.vertices, path.ahead) == (whole.vertices, whole.ahead)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_is_left_out(value: float) -> None:
    path = DrivenPath(Pose(), 0.0, hold=1.0)
    path.drive([Command(0.0, 0.5, 0.0), Command(0.2, value, 0.0), Command(0.3, 0.0, value)], 0.4)
    assert path.pose == pytest.approx((0.2, 0, 0))


@pytest.mark.parametrize("linear", [1e9, 1e308])
def test_a_robot_stays_on_the_map(linear: float) -> None:
    path = DrivenPath(Pose(), 0.0, hold=1.0)
    path.drive([Command(0.0, linear, 0.0)], 0.9)
    assert math.hypot(*path.pose[:2]) < FARTHEST
    assert np.isfinite(path.vertices).all()


def test_old_vertices_are_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    most = 2000
    monkeypatch.setattr(motion, "MOST_VERTICES", most)
    path = DrivenPath(Pose(), 0.0, hold=1.0)
    for begin in range(0, 3 * most, 100):
        times = [0.01 * (begin + n) for n in range(100)]
        path.drive([Command(t, 1.0, 0.1 * (n % 2)) for n, t in enumerate(times)], times[-1])
    assert len(path.vertices) <= most
    assert path.dropped + len(path.vertices) > 0.9 * 3 * most
