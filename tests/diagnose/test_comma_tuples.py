"""A comma at the end of a line makes a tuple of what stands before it, whatever that is and wherever it is used."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text
from ros2lab.diagnose.code.expression_faults import comma_faults
from ros2lab.diagnose.sources.python_source import PythonSource

WRONG = [
    ("msg.data = 1,", "msg.data = 1"),
    ("msg.linear.x = 0.5,  # m/s", "msg.linear.x = 0.5"),
    ("msg.pose.position = Point(),", "msg.pose.position = Point()"),
    ("rate = 10,\nperiod = 1 / rate", "rate = 10"),
    ("def f():\n    return 0.5,\nx = f() + 1", "return 0.5"),
    ("sizes = [1, 2],\nprint(max(sizes))", "sizes = [1, 2]"),
]
RIGHT = [
    "sizes = (1,)",
    "sizes = 1,\nfor size in sizes:\n    print(size)",
    "sizes = 1,\nfirst = sizes[0]",
    "sizes = 1,\nfirst, = sizes",
    "sizes = 1,\nprint(*sizes)",
    "args = name,\nThread(target=work, args=args)",
    "x, = f()",
    "def f():\n    return 1,\n(x,) = f()",
    "def update(frame):\n    return line,\nFuncAnimation(figure, update)",
    "x = f(1,)",
    "x = 1, 2",
    "names += 'a',",
]


@pytest.mark.parametrize(("text", "line"), WRONG)
def test_the_comma_is_told(text: str, line: str) -> None:
    (found,) = comma_faults(PythonSource("a", "a.py", f"{text}\n"))
    assert (found.code, found.fix) == ("comma-tuple", f"write `{line}`, with no comma at its end")


@pytest.mark.parametrize("text", RIGHT)
def test_a_tuple_that_is_meant_stays(text: str) -> None:
    assert [*comma_faults(PythonSource("a", "a.py", f"{text}\n"))] == []


@pytest.mark.parametrize(
    ("lines", "number", "error"),
    [
        (["msg = String()", "msg.data = 'a',", "self.pub.publish(msg)"], 3, "TypeError: bad argument type for built-in operation"),
        (["msg = String()", "msg.data = 'a',"], 2, "AssertionError: The 'data' field must be of type 'str'"),
        (["period = 0.5,", "self.create_timer(period, self.tick)"], 2, "TypeError: float() argument must be a string or a real number, not 'tuple'"),
        (["self.n = 0,", "self.n += 1"], 2, 'TypeError: can only concatenate tuple (not "int") to tuple'),
    ],
)  # fmt: skip
def test_an_error_that_comes_later_leads_to_the_comma(
    tmp_path: Path, lines: list[str], number: int, error: str
) -> None:
    files = Files.right(NAMES[1])
    files.change("node", "self.count = 0", "\n        ".join(["self.count = 0", *lines]))
    root = files.write(tmp_path)
    file = root / "src/my_bot/my_bot/talker.py"
    written = file.read_text().splitlines()
    line = written.index(f"        {lines[number - 1]}") + 1
    comma = next(n for n, text in enumerate(written, 1) if text.endswith(","))
    text = f'Traceback (most recent call last):\n  File "{file}", line {line}, in __init__\n    {lines[number - 1]}\n{error}\n'
    found = of_text(text, root)[0]
    assert (found.code, found.place) == ("comma-tuple", f"src/my_bot/my_bot/talker.py:{comma}")
