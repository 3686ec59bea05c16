"""What lesson 7 asks beyond the assignment, as data: `lesson.yaml` beside `assignment.yaml`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources

import yaml

from ros2lab.assignments.assignment import WEEK_2


@dataclass(frozen=True)
class Lesson:
    """What is asked of the nodes; speeds in m/s and rad/s, periods in s.

    Attributes:
        workspace: the name of the folder in which it is done.
        icons: of the buttons, by command.
        state_topic: on which the node that takes commands tells the others the state, as a String.
        first_state: before any command.
        state_after: the state to which each command leads.
        conversation: what is said, and the state that must follow; None leaves it as it is.
        nonsense: what must be warned of.
        velocity_period: of the velocities.
        velocities: the numbers that are not zero, by state and field.
        speed_parameter: the parameter for the first of them.
        other_speed: that it is given while the node runs.
        configured_period: that the parameter file sets.
        configured_speed: the same.
        refused_periods: values of a period that make no sense.
        functions: that the student's tests must look at.
    """

    workspace: str
    icons: Mapping[str, str]
    state_topic: str
    first_state: str
    state_after: Mapping[str, str]
    conversation: Sequence[tuple[str, str | None]]
    nonsense: Sequence[str]
    velocity_period: float
    velocities: Mapping[str, Mapping[str, float]]
    speed_parameter: str
    other_speed: float
    configured_period: float
    configured_speed: float
    refused_periods: Sequence[str]
    functions: Sequence[str]


@cache
def load_lesson() -> Lesson:
    """Read what the course's own lesson asks."""
    file = resources.files("ros2lab.assignments").joinpath(f"{WEEK_2}/lesson.yaml")
    return Lesson(**yaml.safe_load(file.read_text(encoding="utf-8")))
