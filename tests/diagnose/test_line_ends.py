"""Lines that are compared with their line end, and lines from which it was taken, or in which it is meant."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.line_ends import line_end_faults
from ros2lab.diagnose.finding import Finding

NODE = """
    import sys

    STOP = 'stop'

    def load(path):
        with open(path) as f:
            return f.readlines()

    class Dancer:
        def __init__(self):
            self.steps = load('a.txt')
            self.clean = [step.strip() for step in load('a.txt')]
            self.file = open('b.txt')

        def dance(self, f):
            LINES
"""


def told(lines: str, folder: Path) -> list[Finding]:
    indented = textwrap.indent(textwrap.dedent(lines).strip(), " " * 12).strip()
    text = textwrap.dedent(NODE.replace("LINES", indented))
    return [*line_end_faults(sources_of(text, folder, "dancer"))]


@pytest.mark.parametrize(
    ("lines", "text"),
    [
        ("step = self.steps[0]\nif step == 'left': print(1)\nelif step == 'right': print(2)", "step"),
        ("for line in open('a'):\n  if line == 'on': print(1)", "line"),
        ("line = sys.stdin.readline()\nif line != STOP: print(1)", "line"),
        ("for line in sys.stdin:\n  if line in ('on', 'off'): print(1)", "line"),
        ("with open('a', 'r') as g:\n  for i, line in enumerate(g):\n    print(line == 'go')", "line"),
        ("for line in self.file:\n  name, mode = line.split(',')\n  if mode == 'fast': print(1)", "mode"),
        ("for line in self.steps:\n  if line.lower() == 'left': print(1)", "line.lower()"),
        ("if self.file.readline() == 'on': print(1)", "self.file.readline()"),
        ("words = [w for w in self.steps if w != 'left']", "w"),
    ],
)
def test_the_line_end_is_told(tmp_path: Path, lines: str, text: str) -> None:
    (found,) = told(lines, tmp_path)
    assert found.code == "never-equal"
    assert f"write {text}.strip() instead of {text}" in found.fix


@pytest.mark.parametrize(
    "lines",
    [
        "step = self.clean[0]\nif step == 'left': print(1)",
        "for line in open('a'):\n  line = line.strip()\n  if line == 'on': print(1)",
        "for line in open('a'):\n  if line.strip() == 'on': print(1)",
        "for line in open('a').read().splitlines():\n  if line == 'on': print(1)",
        "for line in map(str.strip, open('a')):\n  if line == 'on': print(1)",
        "for line in open('a'):\n  if line == 'on\\n' or line == '\\n': print(1)",
        "line = self.file.readline()\nif line == '': print('end')",
        "for line in open('a'):\n  words = line.split()\n  if words[-1] == 'on': print(1)",
        "for line in self.file:\n  name, mode = line.split(',')\n  if name == 'x': print(1)",
        "for line in open('a', 'rb'):\n  if line == 'on': print(1)",
        "for line in f:\n  if line == 'on': print(1)",
        "for line in open('a'):\n  if 'on' in line: print(1)",
        "for line in open('a'):\n  if line[0] == '#': print(1)",
        "for line in open('a'):\n  if line.startswith('on'): print(1)",
        "if input() == 'on': print(1)",
        "if open('a').read() == 'on': print(1)",
    ],
)
def test_what_has_no_line_end_is_left_alone(tmp_path: Path, lines: str) -> None:
    assert told(lines, tmp_path) == []
