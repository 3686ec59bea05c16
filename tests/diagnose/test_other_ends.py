"""Errors whose cause lies elsewhere than on their line: at the other end of a topic, or where a thread was made."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_text
from ros2lab.diagnose.finding import Finding

NODE = """\
import json
import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Scanner(Node):
    def __init__(self):
        super().__init__('scanner')
        self.pub = self.create_publisher(String, '/robot/command', 10)
        self.timer = self.create_timer(1.0, self.scan)

    async def wipe(self, text):
        await self.pause()
        self.get_logger().info(text)

    def scan(self):
        parcel = {'id': 1}
        x, y = 3.5, 4.5
        LINE


def main(args=None):
    rclpy.init(args=args)
    node = Scanner()
    START
    rclpy.spin(node)
"""
NO_JSON = "json.decoder.JSONDecodeError: Expecting property name enclosed in double quotes: line 1 column 2"
NO_FLOAT = "ValueError: could not convert string to float: '3.5,4.5'"


def first(root: Path, line: str, error: str, *, start: str = "pass", read: str = "") -> Finding:
    """Return the first finding for an error of the thread, or of the listener at the line that reads."""
    files = right_workspace()
    files.put("node", NODE.replace("LINE", line).replace("START", start))
    frame = '  File "/usr/lib/python3.11/threading.py", line 982, in run\n    self._target(*self._args)\n'
    if read:
        listener = files.texts[files.path("listener")]
        old = listener[listener.index("def command_callback") :].splitlines()[1].strip()
        files.change("listener", old, read)
        number = files.texts[files.path("listener")].partition(read)[0].count("\n") + 1
        place = root / files.path("listener")
        frame = f'  File "{place}", line {number}, in command_callback\n    {read}\n'
    return of_text(f"Traceback (most recent call last):\n{frame}{error}\n", files.write(root))[0]


@pytest.mark.parametrize(
    ("line", "error", "read", "fix"),
    [
        ("msg = String(); msg.data = str(parcel)", NO_JSON, "json.loads(msg.data)", "write `json.dumps(parcel)`"),
        ("self.pub.publish(String(data=f'{parcel}'))", NO_JSON, "json.loads(msg.data)", "write `json.dumps(parcel)`"),
        ("self.pub.publish(String(data=f'{x},{y}'))", NO_FLOAT, "x = float(msg.data)", "in the form that is read there"),
    ],
)  # fmt: skip
def test_what_the_other_end_writes_is_told(
    tmp_path: Path, line: str, error: str, read: str, fix: str
) -> None:
    found = first(tmp_path, line, error, read=read)
    assert found.place.endswith(":22")
    assert fix in found.fix


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("msg = String(data='1'); msg.data = str(parcel)", NO_JSON),
        ("self.pub.publish(String(data=f'{x}'))", NO_FLOAT),
        ("self.pub.publish(String(data=f'at {x}'))", NO_FLOAT),
    ],
)
def test_what_may_not_be_the_text_is_not_blamed(tmp_path: Path, line: str, error: str) -> None:
    read = "json.loads(msg.data)" if error is NO_JSON else "x = float(msg.data)"
    assert not first(tmp_path, line, error, read=read).place.endswith(":22")


NO_TUPLE = "TypeError: rclpy.spin() argument after * must be an iterable, not Scanner"
LETTERS = "TypeError: Scanner.wipe() takes 2 positional arguments but 6 were given"


@pytest.mark.parametrize(
    ("start", "error", "fix"),
    [
        ("threading.Thread(target=rclpy.spin, args=(node)).start()", NO_TUPLE, "write `args=(node,)` instead of `args=(node)`"),
        ("threading.Timer(1.0, rclpy.spin, args=node).start()", NO_TUPLE, "write `args=(node,)` instead of `args=node`"),
        ("threading.Thread(target=node.wipe, args=('start')).start()", LETTERS, "write `args=('start',)` instead of `args=('start')`"),
        ("threading.Thread(target=node.wipe, args=('a', 'b')).start()", LETTERS, ""),
        ("threading.Thread(target=rclpy.spin, args=[node]).start()", NO_TUPLE, ""),
    ],
)  # fmt: skip
def test_a_lone_argument_for_a_thread_needs_a_comma(tmp_path: Path, start: str, error: str, fix: str) -> None:
    found = first(tmp_path, "pass", error, start=start)
    assert found.fix.startswith(fix) if fix else ",) instead" not in found.fix


def test_a_warning_gives_way_to_what_is_known_of_its_line(tmp_path: Path) -> None:
    files = right_workspace()
    files.put("node", NODE.replace("LINE", "self.wipe('slow')").replace("START", "pass"))
    warning = f"{tmp_path / files.path('node')}:22: RuntimeWarning: coroutine 'Scanner.wipe' was never awaited\n  self.wipe('slow')\n"
    found = of_text(f"$ ros2 run my_bot node\n{warning}", files.write(tmp_path))[0]
    assert found.code == "no-effect"
    assert "`async def scan` on line 19" in found.fix
