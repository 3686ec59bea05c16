"""One object where several were meant: in a list, under two names, in a class's body; and what looks like it and is right."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.shared_objects import shared_objects
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.uses import Uses

NODE = """
    import copy
    import rclpy
    from rclpy.node import Node
    from geometry_msgs.msg import Point, PoseStamped, Twist
    from nav_msgs.msg import Path

    class Tracer(Node):
        def __init__(self):
            super().__init__('tracer')
            self.path, self.points, self.seen = Path(), [], {{}}
            self.pose = PoseStamped()
            self.twist = Twist()
            self.last = None
            {first}
            self.create_timer(0.1, self.tick)

        def tick(self):
            {body}

    class Wheel:
        sizes = []
        {method}

    def main():
        left, right = Wheel(), Wheel()
        {main}
"""
MOVES = "self.pose.pose.position.x += 0.1; "


def told(
    tmp_path: Path, body: str = "pass", first: str = "pass", main: str = "pass", method: str = "pass"
) -> list[Finding]:
    """Return what is said of a node that is written like this."""
    text = textwrap.dedent(NODE).format(body=body, first=first, main=main, method=method)
    return [*shared_objects(Uses(sources_of(text, tmp_path, "tracer")))]


@pytest.mark.parametrize(
    ("where", "code", "fix"),
    [
        ("body", MOVES + "self.path.poses.append(self.pose)", "copy.deepcopy(self.pose)"),
        ("body", "self.path.poses.insert(0, self.pose); " + MOVES, "copy.deepcopy(self.pose)"),
        ("body", MOVES + "self.seen[self.path.header.frame_id] = self.pose", "copy.deepcopy(self.pose)"),
        ("body", "print(self.last); self.last = self.twist; self.twist.linear.x += 0.1", "copy.deepcopy(self.twist)"),
        ("body", "self.points.append(self.twist); self.twist.angular.z = 1.0", "copy.deepcopy(self.twist)"),
        ("main", "p = Point(); l = []\n    for i in range(3): p.x = float(i); l.append(p)", "move `p = Point()` into the loop"),
        ("main", "p = Point()\n    p.z = 1.0\n    l = []\n    p.y = 2.0\n    for i in range(3): p.x = float(i); l.append(p)", "move `p = Point()` into the loop, and after it lines 28 and 30"),
        ("main", "p = Point(); l = []\n    p.z = 1.0\n    for i in range(3): p.x = float(i); l.append(p)", "into the loop, and after it line 28"),
        ("main", "row = []; grid = []\n    while len(grid) < 3: row.append(0); grid.append(row)", "move `row = []` into the loop"),
        ("main", "grid = [[0, 0]] * 3; grid[1][0] = 5", "[[0, 0] for _ in range(3)]"),
        ("main", "grid = [[0] * 3] * 2; grid[1][0] = 5", "[[0] * 3 for _ in range(2)]"),
        ("main", "ps = [Point()] * 4; ps[2].x = 1.0", "[Point() for _ in range(4)]"),
        ("main", "d = dict.fromkeys(['a', 'b'], []); d['a'].append(1)", "{key: [] for key in ['a', 'b']}"),
        ("method", "def add(self, size): self.sizes.append(size)", "self.sizes = []"),
        ("method", "def add(self, size): self.sizes[0] = size", "self.sizes = []"),
    ],
)  # fmt: skip
def test_it_is_found_with_what_makes_several(tmp_path: Path, where: str, code: str, fix: str) -> None:
    found = told(tmp_path, **{where: code})
    assert [one.code for one in found] == ["one-object"], found
    assert fix in found[0].fix


@pytest.mark.parametrize(
    ("where", "code"),
    [
        ("body", MOVES + "self.path.poses.append(copy.deepcopy(self.pose))"),
        ("body", "self.pose = PoseStamped(); " + MOVES + "self.path.poses.append(self.pose)"),
        ("body", MOVES + "self.path.poses = []; self.path.poses.append(self.pose)"),
        ("body", MOVES + "self.points.clear(); self.points.append(self.pose)"),
        ("body", "pose = PoseStamped(); pose.pose.position.x = 1.0; self.path.poses.append(pose)"),
        ("body", "print(self.last); self.last = self.twist; self.twist = Twist()"),
        ("body", "self.seen['pose'] = self.pose; " + MOVES),
        ("body", "self.points.append(self.pose)"),
        ("body", "twist = self.twist; twist.linear.x = 0.2"),
        ("main", "l = []\n    for i in range(3): p = Point(); p.x = float(i); l.append(p)"),
        ("main", "p = Point(); l = []\n    for i in range(3): p = Point(x=float(i)); l.append(p)"),
        ("main", "p = Point(); l = []\n    for i in range(3):\n        p.x += 1.0\n        l.append(p)\n        break"),
        ("main", "t = 0; l = []\n    for i in range(3): t += i; l.append(t)"),
        ("main", "grid = [0] * 3; grid[1] = 5"),
        ("main", "grid = [[]] * 2; grid[0] = [1]; grid[1] = [2]; grid[0][0] = 3"),
        ("main", "ps = [Point()] * 4; print(ps[2].x)"),
        ("method", "def count(self): return len(self.sizes)"),
        ("method", "def __init__(self): self.sizes = []\n    def add(self, size): self.sizes.append(size)"),
        ("method", "def __init__(self): self.sizes.append(self)"),
    ],
)  # fmt: skip
def test_what_is_made_or_copied_each_time_is_left_alone(tmp_path: Path, where: str, code: str) -> None:
    assert told(tmp_path, **{where: code}) == []


def test_what_init_keeps_of_itself_moves_along(tmp_path: Path) -> None:
    found = told(tmp_path, first="self.home = self.pose", body="print(self.home); " + MOVES)
    assert [one.code for one in found] == ["one-object"]
    assert "self.home gets the object self.pose itself" in found[0].cause
