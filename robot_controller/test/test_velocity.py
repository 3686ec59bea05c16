"""How fast the robot should go."""

import pytest

from robot_controller.robot_state import State
from robot_controller.velocity import Velocity, velocity_in


@pytest.mark.parametrize(
    ("state", "velocity"),
    [
        (State.RUNNING, (0.5, 0.2)),
        (State.IDLE, (0.0, 0.0)),
        (State.STOPPED, (0.0, 0.0)),
        (None, (0.0, 0.0)),
    ],
)
def test_it_moves_only_while_running(state: State | None, velocity: tuple[float, float]) -> None:
    """Only a running robot moves; an unknown state is none to drive in."""
    assert velocity_in(state, Velocity(0.5, 0.2)) == velocity
