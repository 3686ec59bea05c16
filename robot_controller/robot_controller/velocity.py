"""How fast the robot should go; no ROS here."""

from typing import NamedTuple

from robot_controller.robot_state import State


class Velocity(NamedTuple):
    """A planar velocity: `linear` in m/s, forward; `angular` in rad/s, to the left."""

    linear: float
    angular: float


STANDSTILL = Velocity(0.0, 0.0)


def velocity_in(state: State | None, cruise: Velocity) -> Velocity:
    """Return the cruising velocity while running, and else standstill; None: state unknown."""
    return cruise if state is State.RUNNING else STANDSTILL
