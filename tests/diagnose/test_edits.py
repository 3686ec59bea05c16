"""A fix that changes nothing, or takes away a name that is used elsewhere, is none."""

from __future__ import annotations

import pytest

from ros2lab.diagnose.checking.edits import Edit, revealing
from ros2lab.diagnose.sources.python_source import PythonSource

TEXT = """\
class Arm:
    def __init__(self):
        self.joint = 'elbow'
        self.angle = 0.5
        self.names = LINE

    def tick(self):
        angle = self.read()
        other = self.read()
        print(angle, self.names)
"""


def edited(line: str, new: str) -> tuple[Edit, PythonSource]:
    source = PythonSource("arm", "arm.py", TEXT.replace("LINE", "[]"))
    node = next(n for n in source.nodes if getattr(n, "lineno", 0) and line == _text(source, n))
    return Edit(node, new), source  # type: ignore[arg-type]


def _text(source: PythonSource, node: object) -> str:
    first, last = node.lineno, node.end_lineno  # type: ignore[attr-defined]
    if first != last:
        return ""
    row = source.text.splitlines()[first - 1].encode()
    return row[node.col_offset : node.end_col_offset].decode()  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("line", "new", "is_idle"),
    [
        ("self.joint = 'elbow'", "self.joint = str('elbow')", True),
        ("self.joint = 'elbow'", 'self.joint = "elbow"', True),
        ("self.joint = 'elbow'", "self.joint = ('elbow')", True),
        ("'elbow'", "str('elbow')", True),
        ("self.angle = 0.5", "self.angle = float(0.5)", True),
        ("self.joint = 'elbow'", "self.joint = str(self.joint)", False),
        ("self.joint = 'elbow'", "self.joint = ['elbow']", False),
        ("self.angle = 0.5", "self.angle = int(0.5)", False),
        ("self.angle = 0.5", "self.angle = str(0.5)", False),
    ],
)
def test_what_means_the_same_is_idle(line: str, new: str, is_idle: bool) -> None:
    edit, source = edited(line, new)
    assert edit.is_idle(source) is is_idle


@pytest.mark.parametrize(
    ("line", "new", "keeps"),
    [
        ("angle = self.read()", "self.read()", False),
        ("angle = self.read()", "self.read(); angle = 0.0", True),
        ("angle = self.read()", "turn = self.read()", False),
        ("self.names = []", "self.read()", False),
        ("other = self.read()", "self.read()", True),
        ("self.read()", "self.joint", True),
    ],
)
def test_a_name_that_is_used_is_kept(line: str, new: str, keeps: bool) -> None:
    edit, source = edited(line, new)
    assert edit.keeps_names(source) is keeps


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("a(b(c()))\n", "reveal_type(a(reveal_type(b(reveal_type(c())))))\n"),
        ("a(\n    b(\n        1),\n    2)\n", "reveal_type(a(\n    reveal_type(b(\n        1)),\n    2))\n"),
        ("a()()\n", "reveal_type(reveal_type(a())())\n"),
        ("ä(b(), c())\n", "reveal_type(ä(reveal_type(b()), reveal_type(c())))\n"),
    ],
)
def test_calls_that_lie_in_each_other_are_asked_for_their_types(text: str, shown: str) -> None:
    source = PythonSource("arm", "arm.py", text)
    assert revealing(source, [*source.calls]).decode() == shown
