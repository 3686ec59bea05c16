"""Iterators that are walked through again, and what may be walked through as often as one likes."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.one_time import one_time_faults
from ros2lab.diagnose.finding import Finding

NODE = """
    import csv
    import itertools
    from rclpy.node import Node

    def numbers():
        yield 1

    class Lamp(Node):
        def __init__(self):
            super().__init__('lamp')
            self.it = MADE
            self.create_timer(1.0, self.tick)

        def tick(self):
            self.blink()

        def blink(self):
            LINES

    def main():
        rows = ['a', 'b']
        MAIN
"""


def told(folder: Path, made: str = "None", lines: str = "pass", main: str = "pass") -> list[Finding]:
    def indented(text: str, by: int) -> str:
        return textwrap.indent(textwrap.dedent(text).strip(), " " * by).strip()

    text = NODE.replace("MADE", made).replace("LINES", indented(lines, 12)).replace("MAIN", indented(main, 8))
    text = textwrap.dedent(text)
    return [*one_time_faults(sources_of(text, folder, "lamp"))]


WALK = "for one in self.it:\n  print(one)"


@pytest.mark.parametrize(
    ("made", "lines", "fix"),
    [
        ("map(float, '1 2'.split())", WALK, "write self.it = list(map(float, '1 2'.split()))"),
        ("zip([1], [2])", "print(list(self.it))", "list(zip([1], [2]))"),
        ("(x for x in [1, 2])", "total = sum(self.it)", "write self.it = [x for x in [1, 2]]"),
        ("open('a.txt')", WALK, "open('a.txt').readlines()"),
        ("csv.reader(open('a.csv'))", "print([row for row in self.it])", "list(csv.reader(open('a.csv')))"),
        ("numbers()", "for i, one in enumerate(self.it):\n  print(i, one)", "list(numbers())"),
        ("filter(None, [1, 0])", "print(' '.join(self.it))", "list(filter(None, [1, 0]))"),
    ],
)
def test_a_callback_that_walks_again_is_told(tmp_path: Path, made: str, lines: str, fix: str) -> None:
    (found,) = told(tmp_path, made, lines)
    assert found.code == "used-up"
    assert fix in found.fix


@pytest.mark.parametrize(
    "main",
    [
        "it = map(int, rows)\nprint(sum(it))\nprint(max(it))",
        "it = zip(rows, rows)\nfor turn in range(3):\n  for a, b in it:\n    print(a, b)",
        "it = (r for r in rows)\nfor r in it:\n  print(r)\nprint(list(it))",
        "with open('a') as f:\n  it = csv.reader(f)\n  n = len(list(it))\n  for row in it:\n    print(row)",
        "it = reversed(rows)\nwhile True:\n  for r in it:\n    print(r)",
    ],
)
def test_a_variable_that_is_walked_twice_is_told(tmp_path: Path, main: str) -> None:
    (found,) = told(tmp_path, main=main)
    assert found.code == "used-up"


@pytest.mark.parametrize(
    ("made", "lines"),
    [
        ("list(map(float, '1 2'.split()))", WALK),
        ("[1, 2]", WALK),
        ("itertools.cycle([1, 2])", WALK),
        ("range(3)", WALK),
        ("map(float, '1 2'.split())", "print(next(self.it))"),
        ("map(float, '1 2'.split())", "for one in self.it:\n  print(one)\n  break"),
        ("iter([1, 2])", "for one in self.it:\n  return one"),
        ("zip([1], [2])", WALK + "\nself.it = zip([3], [4])"),
        ("open('a.txt')", WALK + "\nself.it.seek(0)"),
        ("map(float, '1 2'.split())", WALK + "\nself.timer.cancel()"),
    ],
)
def test_what_lasts_or_is_taken_bit_by_bit_is_left_alone(tmp_path: Path, made: str, lines: str) -> None:
    assert told(tmp_path, made, lines) == []


@pytest.mark.parametrize(
    "main",
    [
        "it = map(int, rows)\nprint(sum(it))",
        "it = list(map(int, rows))\nprint(sum(it))\nprint(max(it))",
        "it = iter(rows)\nnext(it)\nfor r in it:\n  print(r)",
        "it = map(int, rows)\nif rows:\n  print(sum(it))\nelse:\n  print(max(it))",
        "for r in rows:\n  it = map(int, r)\n  print(sum(it))",
        "it = iter(rows)\nfor a in it:\n  for b in it:\n    print(a, b)",
        "it = iter(rows)\nprint(list(zip(it, it)))",
        "it = map(int, rows)\nprint(sum(it))\nit = map(int, rows)\nprint(max(it))",
        "it = filter(None, rows)\nwhile True:\n  for r in it:\n    print(r)\n  break",
    ],
)
def test_a_variable_that_is_walked_once_is_left_alone(tmp_path: Path, main: str) -> None:
    assert told(tmp_path, main=main) == []
