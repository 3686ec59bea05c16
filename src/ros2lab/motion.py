"""How a robot on two wheels moves on a plane: pure functions, and the path that commands make it drive.

A command holds until the next one, so between two of them the robot drives on a straight line or on an arc of a
circle. Both are computed exactly and not in small steps (B. Siciliano et al., Robotics, 2009, section 11.6:
"exact integration" of the unicycle model).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

VERTEX_TURN = 0.05  # rad between two vertices of an arc: at a radius of 2.5 m it is off by 0.8 mm
VERTEX_DISTANCE = 0.005  # m, which vertices are apart at least
MOST_VERTICES_A_STEP = 64
MOST_VERTICES = 20_000
FARTHEST = 1e6  # m from the origin, where every map ends


class Pose(NamedTuple):
    """Where a robot is.

    Attributes:
        x: in m.
        y: in m.
        heading: in rad, counter-clockwise from the x axis; it counts full turns.
    """

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0


class Command(NamedTuple):
    """A velocity that holds from a time on.

    Attributes:
        time: in s.
        linear: forward, in m/s.
        angular: to the left, in rad/s.
    """

    time: float
    linear: float
    angular: float


def moved(pose: Pose, linear: float, angular: float, duration: float) -> Pose:
    """Return the pose after driving for a while with a constant velocity, exactly.

    Args:
        pose: where the robot begins.
        linear: forward, in m/s.
        angular: to the left, in rad/s.
        duration: in s.
    """
    distance, turn = linear * duration, angular * duration
    # The chord of the arc, in the direction half-way between both headings: the limit of a straight line is
    # reached without a division by a small number.
    chord = distance * (math.sin(turn / 2) / (turn / 2) if turn else 1.0)
    direction = pose.heading + turn / 2
    return Pose(
        pose.x + chord * math.cos(direction), pose.y + chord * math.sin(direction), pose.heading + turn
    )


class DrivenPath:
    """A robot's way: commands lead it, and its vertices can be drawn.

    Args:
        start: where it begins.
        time: when, in s.
        hold: how long a command holds if no other comes, in s; then the robot stops.

    Attributes:
        start: as above.
        pose: where the robot is.
        command: what it is driving; zero once nothing holds any more.
        vertices: corners of the way, (x, y) in m, the first at the start; between them it is straight as far as
            anybody can see. From the last one the way leads to the pose.
        dropped: how many vertices were forgotten at the beginning, because there are too many.
    """

    def __init__(self, start: Pose, time: float, *, hold: float) -> None:
        self.start = self.pose = start
        self.command = Command(time, 0.0, 0.0)
        self.vertices = [(start.x, start.y)]
        self.dropped = 0
        self._hold = hold
        self._time = time
        self._turned = 0.0  # rad, since the last vertex

    def drive(self, commands: Iterable[Command], until: float) -> None:
        """Follow commands, the oldest first.

        Args:
            commands: those that came since the last call; what is not finite is left out.
            until: the time up to which is driven, in s.
        """
        for command in commands:
            if math.isfinite(command.linear) and math.isfinite(command.angular):
                self._drive(command.time)
                if command[1:] != self.command[1:]:
                    self._add_vertex()
                self.command = command
        self._drive(until)
        if until > self.command.time + self._hold and any(self.command[1:]):
            self._add_vertex()
            self.command = Command(self.command.time, 0.0, 0.0)
        if len(self.vertices) > MOST_VERTICES:
            self.dropped += MOST_VERTICES // 4
            del self.vertices[: MOST_VERTICES // 4]

    def _drive(self, until: float) -> None:
        """Drive as the command says, up to a time."""
        _, linear, angular = self.command
        duration = min(until, self.command.time + self._hold) - self._time
        self._time = max(until, self._time)
        if duration <= 0 or not (linear or angular):
            return
        arcs = math.ceil(min(abs(angular) * duration / VERTEX_TURN, MOST_VERTICES_A_STEP)) or 1
        for _ in range(arcs):
            pose = moved(self.pose, linear, angular, duration / arcs)
            if not math.hypot(*pose[:2]) < FARTHEST:  # also true for NaN
                return
            self.pose = pose
            self._turned += abs(angular) * duration / arcs
            if self._turned >= VERTEX_TURN:
                self._add_vertex()

    def _add_vertex(self) -> None:
        if math.dist(self.vertices[-1], self.pose[:2]) >= VERTEX_DISTANCE:
            self.vertices.append(self.pose[:2])
            self._turned = 0.0
