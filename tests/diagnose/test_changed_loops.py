"""Loops that change what they walk over, and loops that only seem to."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.changed_loops import changed_loops
from ros2lab.diagnose.finding import Finding

NODE = """
    from rclpy.node import Node

    class Sorter(Node):
        def __init__(self):
            super().__init__('sorter')
            self.boxes = ['ok', 'bad', 'bad']
            self.seen = {'a': 1}
            self.create_timer(1.0, self.tick)

        def drop(self, box):
            self.boxes.remove(box)

        def tick(self):
            LINES
"""


def told(lines: str, folder: Path) -> list[Finding]:
    indented = textwrap.indent(textwrap.dedent(lines).strip(), " " * 12).strip()
    text = textwrap.dedent(NODE.replace("LINES", indented))
    return [*changed_loops(sources_of(text, folder, "sorter"))]


@pytest.mark.parametrize(
    ("lines", "fix"),
    [
        ("for box in self.boxes:\n  if box == 'bad':\n    self.boxes.remove(box)", "write list(self.boxes) instead of self.boxes"),
        ("for box in self.boxes:\n  if box == 'bad':\n    self.drop(box)", "write list(self.boxes)"),
        ("for key in self.seen:\n  if self.seen[key] > 1:\n    del self.seen[key]", "write list(self.seen)"),
        ("for key, n in self.seen.items():\n  if n > 1:\n    self.seen.pop(key)", "write list(self.seen.items())"),
        ("for i in range(len(self.boxes)):\n  if self.boxes[i] == 'bad':\n    del self.boxes[i]", "write range(len(self.boxes) - 1, -1, -1)"),
        ("for i, box in enumerate(self.boxes):\n  if box == 'bad':\n    self.boxes.pop(i)", "write reversed(list(enumerate(self.boxes)))"),
        ("names = {'a', 'b'}\nfor name in names:\n  try:\n    names.discard(name)\n  finally:\n    pass", "write list(names)"),
        ("for box in self.boxes:\n  for letter in box:\n    if letter == 'b':\n      self.boxes.remove(box)\n      break", "write list(self.boxes)"),
        ("for box in self.boxes:\n  self.boxes.append(box)", "write list(self.boxes)"),
        ("for box in self.boxes:\n  if box == 'ok':\n    continue\n  last = self.boxes.pop()", "write list(self.boxes)"),
    ],
)  # fmt: skip
def test_a_change_in_the_loop_is_told_with_the_copy(tmp_path: Path, lines: str, fix: str) -> None:
    (found,) = told(lines, tmp_path)
    assert found.code == "changed-in-loop"
    assert fix in found.fix


@pytest.mark.parametrize(
    "lines",
    [
        "for box in list(self.boxes):\n  self.boxes.remove(box)",
        "for box in self.boxes[:]:\n  self.boxes.remove(box)",
        "for box in self.boxes.copy():\n  self.drop(box)",
        "for key in sorted(self.seen):\n  del self.seen[key]",
        "for box in self.boxes:\n  if box == 'bad':\n    self.boxes.remove(box)\n    break",
        "for box in self.boxes:\n  if box == 'bad':\n    self.drop(box)\n    return",
        "for box in self.boxes:\n  for letter in box:\n    if letter == 'b':\n      self.boxes.remove(box)\n      break\n  break",
        "for key in self.seen:\n  self.seen[key] = 0",
        "for key, n in self.seen.items():\n  self.seen[key] = n + 1",
        "others = []\nfor box in self.boxes:\n  others.append(box)",
        "for box in self.boxes:\n  self.seen.pop(box, None)",
        "for i in range(len(self.boxes) - 1, -1, -1):\n  del self.boxes[i]",
        "for i in range(len(self.boxes)):\n  print(self.boxes.pop())",
        "for box in self.boxes:\n  if box == 'ok':\n    self.boxes.append('more')",
        "for box in self.boxes:\n  self.boxes = [one for one in self.boxes if one != box]\n  self.boxes.append(box)",
        "while self.boxes:\n  self.boxes.pop()",
        "for node in self.seen:\n  def later():\n    self.seen.pop(node)\n  self.create_timer(1.0, later)",
    ],
)  # fmt: skip
def test_a_copy_or_an_end_is_left_alone(tmp_path: Path, lines: str) -> None:
    assert told(lines, tmp_path) == []
