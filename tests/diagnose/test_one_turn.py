"""Loops that always end in their first turn, and floats that are never equal to what they are compared with."""

from __future__ import annotations

import math
import textwrap
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.flow_faults import flow_faults

FIND = "for row in rows:\n    if row.ok:\n        return row\n    "
STEPS = """\
class Mast(Node):
    def __init__(self):
        self.height = {start}
        self.target = {target}

    def lift(self):
        if {test}:
            print('there')
        {step}
"""


def found(text: str, folder: Path, code: str) -> list[str]:
    return [one.fix for one in flow_faults(sources_of(text, folder)) if one.code == code]


def in_function(body: str) -> str:
    return f"def work(rows, node):\n    total = 0\n{textwrap.indent(body, '    ')}\n"


@pytest.mark.parametrize(
    ("body", "fix"),
    [
        ("for row in rows:\n    if row > 3:\n        return False\n    else:\n        return True", "such as `return True`"),
        (f"{FIND}return None", "such as `return None`"),
        (f"{FIND}else:\n        raise ValueError(row)", "such as `raise ValueError(row)`"),
        ("for row in rows:\n    if row < 1:\n        node.a()\n        break\n    elif row < 2:\n        break\n    else:\n        return 2", "such as `return 2`"),
        ("for row in rows:\n    total += row\n    return total", "write `return total` below the loop"),
        ("while rows:\n    if rows.pop():\n        return 1\n    return 2", "such as `return 2`"),
    ],
)  # fmt: skip
def test_a_loop_that_looks_at_one_thing_only_is_told(tmp_path: Path, body: str, fix: str) -> None:
    (told,) = found(in_function(body), tmp_path, "unreachable")
    assert fix in told


@pytest.mark.parametrize(
    "body",
    [
        "for row in rows:\n    return row\nreturn None",
        "for row in rows:\n    break\nprint(row)",
        "for row in rows:\n    node.publish(row)\n    return",
        "for row in rows:\n    if not row:\n        continue\n    return row",
        "for row in rows:\n    if row:\n        return row\n    node.look(row)",
        "for row in rows:\n    try:\n        return row()\n    except OSError:\n        total += 1",
        "while True:\n    if rows:\n        break\n    node.a()\n    break",
        "while not node.ready():\n    node.log('not there')\n    return",
        "for row in rows:\n    if row:\n        break\n    break\nelse:\n    print('none')",
        "for row in rows:\n    total += row\n    if total > 9:\n        return total",
    ],
)
def test_a_loop_that_goes_on_or_takes_the_first_on_purpose_is_right(tmp_path: Path, body: str) -> None:
    assert found(in_function(body), tmp_path, "unreachable") == []


TEST, STEP = "self.height == self.target", "self.height += 0.1"


@pytest.mark.parametrize(
    ("start", "target", "test", "step", "is_told"),
    [
        (0.0, 0.8, TEST, STEP, True),
        (0.0, 1.0, "self.height != 1.0", STEP, True),
        (1.0, 0.0, TEST, "self.height -= 0.1", True),
        (0.0, 0.8, TEST, "self.height = self.height + 0.1", True),
        (0.0, 0.8, "self.height in (0.8, 2.55)", STEP, True),
        (0.0, 0.5, TEST, STEP, False),  # by luck
        (0.0, 2.0, TEST, "self.height += 0.5", False),
        (0.0, 0.85, TEST, STEP, False),  # it may be meant never to be
        (0, 8, TEST, "self.height += 1", False),
        (0.0, 0.8, TEST, "self.height = round(self.height + 0.1, 1)", False),
        (0.0, 0.8, TEST, "self.height += self.by", False),
        (0.0, 0.8, "round(self.height, 1) == 0.8", STEP, False),
        (0.0, 0.8, "math.isclose(self.height, self.target)", STEP, False),
    ],
)
def test_a_sum_of_steps_that_only_comes_near_is_told(
    tmp_path: Path, start: float, target: float, test: str, step: str, *, is_told: bool
) -> None:
    told = found(STEPS.format(start=start, target=target, test=test, step=step), tmp_path, "never-equal")
    assert ["isclose(self.height, " in fix for fix in told] == [True] * is_told


@pytest.mark.parametrize("target", [n / 10 for n in range(1, 30)])
def test_what_is_told_of_a_sum_is_what_python_sums(tmp_path: Path, target: float) -> None:
    value, values = 0.0, list[float]()
    while value < target + 1:
        values.append(value)
        value += 0.1
    assert any(math.isclose(value, target) for value in values)
    told = found(STEPS.format(start=0.0, target=target, test=TEST, step=STEP), tmp_path, "never-equal")
    assert bool(told) is (target not in values)
