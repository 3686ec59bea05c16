"""Variables that hide what is called under their name, and variables that only have such a name."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.hidden_names import hidden_names
from ros2lab.diagnose.finding import Finding

FILE = """
    import math
    import time
    from pk.tools import scale

    def speed():
        return 3

    class Sensor:
        def tick(self, values):
            LINES
"""


def told(lines: str, folder: Path) -> list[Finding]:
    indented = textwrap.indent(textwrap.dedent(lines).strip(), " " * 12).strip()
    text = textwrap.dedent(FILE.replace("LINES", indented))
    return [*hidden_names(sources_of(text, folder, "sensor"))]


@pytest.mark.parametrize(
    ("lines", "name"),
    [
        ("min = min(values)\nprint(min)", "min"),
        ("time = time.time()\nprint(time)", "time"),
        ("speed = speed()\nreturn speed", "speed"),
        ("r = round(values[0])\nround = r + 1", "round"),
        ("for sum in range(sum(values)):\n  print(sum)", "sum"),
        ("scale = [scale(v) for v in values]", "scale"),
        ("str = 'hello'\nprint(str(5))", "str"),
        ("list = [1, 2]\nreturn list(values)", "list"),
        ("for v in values:\n  max = max(values)\n  print(max)", "max"),
    ],
)
def test_the_variable_gets_another_name(tmp_path: Path, lines: str, name: str) -> None:
    (found,) = told(lines, tmp_path)
    assert found.code == "name-hidden"
    assert f"rename the variable {name} everywhere in tick()" in found.fix


@pytest.mark.parametrize(
    "lines",
    [
        "smallest = min(values)",
        "min = values[0]\nprint(min)",
        "print = self.log\nprint(values)",
        "max = math.fmax\nreturn max(1, 2)",
        "id = values[0]\nreturn id + 1",
        "times = time.time()",
        "self.min = min(values)",
        "if values:\n  open = self.open\nelse:\n  open = self.other\nopen(values)",
        "for v in values:\n  if v:\n    print(sum(values))\n  else:\n    sum = len\n",
        "global speed\nspeed = speed()",
        "def inner():\n  min = 3\n  return min\nreturn min(values)",
        "return [max for max in values], max(values)",
        "import time\nreturn time.time()",
        "input, values = values, input\nreturn input",
    ],
)
def test_a_name_that_hides_nothing_used_is_left_alone(tmp_path: Path, lines: str) -> None:
    assert told(lines, tmp_path) == []
