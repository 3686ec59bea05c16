"""A function that yields runs nothing when it is called, and leaves its loop at each yield."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.nodes.life_faults import life_faults

NODE = """\
import rclpy
from rclpy.node import Node


class Light(Node):
    def __init__(self):
        super().__init__('light')
        self.create_timer(1.0, self.step)
        self.count = 0
        BEGIN

    def step(self):
        self.count += next(self.program, 0)

    def phases(self):
        yield 1
        yield 2

    def cycle(self):
        BODY


def main():
    rclpy.init()
    rclpy.spin(Light())
"""
KEPT = "self.program = self.cycle()"
LOOPS = {
    "a yield": (KEPT, "while True:\n            yield 1", False),
    "a yield from": (KEPT, "while True:\n            yield from self.phases()", False),
    "one step": ("next(self.cycle())", "while True:\n            yield from [1]", False),
    "an inner loop of a generator": (
        KEPT,
        "yield 1\n        while True:\n            self.count += 1",
        False,
    ),
    "no generator": (KEPT, "while True:\n            self.phases()", True),
    "no generator, with one inside": (
        KEPT,
        "def one():\n            yield 1\n        while True:\n            self.count += 1",
        True,
    ),
}


@pytest.mark.parametrize(("begin", "body", "is_told"), LOOPS.values(), ids=LOOPS)
def test_a_loop_that_a_call_does_not_run(tmp_path: Path, begin: str, body: str, is_told: bool) -> None:
    sources = sources_of(NODE.replace("BEGIN", begin).replace("BODY", body), tmp_path)
    assert ("endless-loop" in [one.code for one in life_faults(sources, None)]) == is_told
