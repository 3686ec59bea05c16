"""Parameters that are read once although they are said to change while the node runs: the fix makes them change."""

from __future__ import annotations

import os
import re
import textwrap
from pathlib import Path

import pytest
from one_file import printed_by, sources_of

from ros2lab.diagnose.nodes.stale_values import meant_to_change
from ros2lab.diagnose.sources.uses import State, uses_of

CODE = '''\
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter


class Belt(Node):
    """DOC"""

    def __init__(self):
        super().__init__('belt')
        self.declare_parameter('speed', 0.5)  # COMMENT
SETUP

    def step(self):
        """Move on."""
        print(SHOWN, flush=True)
        self.set_parameters([Parameter('speed', value=0.25)])


def main(args=None):
    rclpy.init(args=args)
    node = Belt()
    for _ in range(2):
        rclpy.spin_once(node)


if __name__ == '__main__':
    main()
'''
DOC = "Runs the belt; its speed shall be changed with ros2 param set while it runs."
KEPT = "self.speed = self.get_parameter('speed').value\nself.create_timer(0.05, self.step)"
SCALED = "self.speed = float(self.get_parameter('speed').value) * 2\nself.create_timer(0.05, self.step)"
VALUE = "self.speed = self.get_parameter('speed').get_parameter_value().double_value\nself.create_timer(0.05, self.step)"
PERIOD = "self.period = self.get_parameter('speed').value\nself.create_timer(self.period, self.step)"
NAMED = (
    "self.period = self.get_parameter('speed').value\nself.beat = self.create_timer(self.period, self.step)"
)
PACE = "self.timers.__next__().timer_period_ns / 1e9"
WRONG = [
    (DOC, "", KEPT, "self.speed", ["0.5", "0.25"]),
    ("", "mit ros2 param set /belt speed 1.0 anders", KEPT, "self.speed", ["0.5", "0.25"]),
    ("A belt.\n\n    Change speed while the node is running: ros2 param set /belt speed 1.0\n    ", "", SCALED, "self.speed", ["1.0", "0.5"]),
    (DOC, "", VALUE, "self.speed", ["0.5", "0.25"]),
    (DOC, "", PERIOD, PACE, ["0.5", "0.25"]),
    (DOC, "", NAMED, PACE, ["0.5", "0.25"]),
]  # fmt: skip
RIGHT = [
    ("Runs the belt.", "m/s", KEPT),
    ("Runs the belt while the motor is running.", "", KEPT),
    ("", "speed is what it runs at, at runtime", KEPT),
    ("Its colour is changed by ros2 param set.", "", KEPT),
    (DOC, "", KEPT.replace("self.speed = ", "first = ")),
    (DOC, "", KEPT + "\n\ndef changed(self, params):\n    self.speed = params[0].value"),
    (DOC, "", KEPT + "\n\ndef again(self):\n    return self.get_parameter('speed').value"),
]


def written(doc: str, comment: str, setup: str, shown: str = "self.speed") -> str:
    head, *rest = setup.split("\n\n")
    body = textwrap.indent(head, " " * 8) + "".join(f"\n\n{textwrap.indent(more, '    ')}" for more in rest)
    code = CODE.replace("DOC", doc or "Runs.").replace("COMMENT", comment).replace("SETUP", body)
    return code.replace("SHOWN", shown)


def told(folder: Path, text: str) -> list[str]:
    sources = sources_of(text, folder)
    states = [State(uses_of(sources), owner) for owner in sources.nodes]
    return [finding.fix for state in states for finding in meant_to_change(state)]


def applied(text: str, fix: str) -> str:
    lines = text.splitlines()
    for line, number in re.findall(r"`(self\.timer = [^`]+)` on line (\d+)", fix):
        lines[int(number) - 1] = f"        {line}"
    (rows,) = re.findall(r"((?:`[^`]+`(?: and )?)+) as the first lines? of step\(\)", fix)
    at = next(number for number, line in enumerate(lines) if "Move on" in line)
    lines[at + 1 : at + 1] = [f"        {row}" for row in re.findall(r"`([^`]+)`", rows)]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(("words", "setup", "shown", "printed"), [(row[:2], *row[2:]) for row in WRONG])
def test_what_is_set_while_it_runs_is_seen(
    tmp_path: Path, words: tuple[str, str], setup: str, shown: str, printed: list[str]
) -> None:
    text = written(*words, setup, shown)
    (fix,) = told(tmp_path, text)
    here = {**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    path = tmp_path / "mended.py"
    path.write_text(applied(text, fix), encoding="utf-8")
    assert printed_by(path, environ=here).split() == printed, fix


@pytest.mark.parametrize(("doc", "comment", "setup"), RIGHT)
def test_nothing_is_said_without_such_words_or_of_what_is_read_again(
    tmp_path: Path, doc: str, comment: str, setup: str
) -> None:
    assert told(tmp_path, written(doc, comment, setup)) == []
