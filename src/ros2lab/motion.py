"""How a robot on two wheels moves on a plane: pure functions, and the path that commands make it drive.

A command holds until the next one, so between two of them the robot drives on a straight line or on an arc of a
circle. Both are computed exactly and not in small steps (B. Siciliano et al., Robotics, 2009, section 11.6:
"exact integration" of the unicycle model).
"""

from __future__ import annotations

import bisect
import itertools
import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

VERTEX_TURN = (
    0.05  # rad after which an arc gets a vertex, late by as much: at most 3 mm off at a radius of 2.5 m
)
VERTEX_DISTANCE = 0.005  # m, which vertices are apart at least
MOST_VERTICES_AN_ARC = 64
MOST_VERTICES = 20_000
FARTHEST = 1e6  # m from the origin, where every map ends; and rad, after which no turn is seen


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

    What it drove up to the last command is settled. What it has driven since is computed from there at each look,
    because a command may become known after a look that is later than the command itself.

    Args:
        start: where it begins.
        time: when, in s.
        hold: how long a command holds if no other comes, in s; then the robot stops.
        command: what it is driving at the start; nothing if it stands.

    Attributes:
        start: as above.
        pose: where the robot is.
        command: what it is driving; zero once nothing holds any more.
        vertices: settled corners of the way, (x, y) in m, the first at the start; between them it is straight as
            far as anybody can see.
        ahead: further corners, from the last vertex to the pose; the next look may take them back.
        dropped: how many vertices were forgotten at the beginning, because there are too many.
    """

    def __init__(self, start: Pose, time: float, *, hold: float, command: Command | None = None) -> None:
        self.start = self.pose = start
        self.command = command or Command(time, 0.0, 0.0)
        self.vertices = [(start.x, start.y)]
        self.ahead: list[tuple[float, float]] = []
        self.dropped = 0
        self._hold = hold
        self._last_command = self.command
        self._settled, self._settled_time = start, time
        self._vertex_heading = start.heading

    def drive(self, commands: Iterable[Command], until: float) -> None:
        """Follow commands, the oldest first.

        Args:
            commands: those that became known since the last call; what is not finite is left out. They may be
                older than the last call's `until`, but not than the commands of that call.
            until: the time up to which is driven, in s.
        """
        for command in commands:
            if math.isfinite(command.linear) and math.isfinite(command.angular):
                self._settle(command)
        *between, self.pose = self._way(until)
        self.ahead = [pose[:2] for pose in between]
        holds = until <= self._last_command.time + self._hold
        self.command = self._last_command if holds else Command(self._last_command.time, 0.0, 0.0)
        while len(self.vertices) > MOST_VERTICES:
            self.dropped += MOST_VERTICES // 4
            del self.vertices[: MOST_VERTICES // 4]

    def _settle(self, command: Command) -> None:
        """Drive up to a command, which holds from there on."""
        way = self._way(command.time)
        for pose in way:
            if abs(pose.heading - self._vertex_heading) >= VERTEX_TURN:
                self._add_vertex(pose)
        self._settled, self._settled_time = way[-1], max(command.time, self._settled_time)
        if command[1:] != self._last_command[1:]:
            self._add_vertex(self._settled)
        self._last_command = command

    def _way(self, until: float) -> list[Pose]:
        """Return the poses from the settled one to that of a time, so close that it is straight between them."""
        time, linear, angular = self._last_command
        duration = min(until, time + self._hold) - self._settled_time
        if duration <= 0 or not (linear or angular):
            return [self._settled]
        arcs = math.ceil(min(abs(angular) * duration / VERTEX_TURN, MOST_VERTICES_AN_ARC)) or 1
        poses = (moved(self._settled, linear, angular, duration * n / arcs) for n in range(arcs + 1))
        return list(itertools.takewhile(_is_on_map, poses))

    def _add_vertex(self, pose: Pose) -> None:
        self._vertex_heading = pose.heading
        if math.dist(self.vertices[-1], pose[:2]) >= VERTEX_DISTANCE:
            self.vertices.append(pose[:2])


class Moment(NamedTuple):
    """Where a robot is at a time, and what it drives from then on.

    Attributes:
        time: in s.
        pose: where it is.
        command: what it is driving.
    """

    time: float
    pose: Pose
    command: Command


def driven(start: Pose, commands: Sequence[Command], times: Iterable[float], *, hold: float) -> list[Moment]:
    """Return where a robot is at some times, if all commands are known.

    Args:
        start: where it begins.
        commands: all of them, oldest first.
        times: in s, ascending.
        hold: how long a command holds if no other comes, in s.
    """
    path = DrivenPath(start, -math.inf, hold=hold)
    moments, begin = [], 0
    for time in times:
        end = bisect.bisect_right(commands, time, lo=begin, key=lambda command: command.time)
        path.drive(commands[begin:end], time)
        moments.append(Moment(time, path.pose, path.command))
        begin = end
    return moments


def _is_on_map(pose: Pose) -> bool:
    return math.hypot(*pose) < FARTHEST  # false for NaN, too
