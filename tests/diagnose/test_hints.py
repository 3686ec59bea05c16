"""Type hints that are wrong do no harm; what a parameter gets counts."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_workspace

HEARD = "        self.get_logger().info(f'I heard: \"{msg.data}\"')\n"
# The first parameter of the callback, what the callback does, and the methods below it.
RIGHT = {
    "callback": ("msg: str", "self.get_logger().info(msg.data)", ""),
    "another message": ("msg: Header", "self.get_logger().info(msg.data)", ""),
    "helper": ("msg", "self.move(msg)", "def move(self, move: str):\n        move = move.data\n        self.get_logger().info(move)"),
    "helper of a hinted callback": ("msg: String", "self.move(msg)", "def move(self, m: float):\n        return m.data"),
    "helper of a helper": ("msg", "self.first(msg)", "def first(self, m):\n        self.second(m)\n\n    def second(self, m: dict):\n        return m.data"),
    "by name": ("msg", "self.move(m=msg)", "def move(self, m: int):\n        return m.data"),
    "text": ("msg: String", "self.move(msg.data)", "def move(self, m: float):\n        return m.upper()"),
    "number": ("msg", "self.move(3)", "def move(self, m: str):\n        return m + 1"),
    "unknown": ("msg", "self.move(self.found())", "def found(self):\n        import other\n        return other.get()\n\n    def move(self, m: str):\n        return m.data"),
    "passed on": ("msg", "rclpy.get_default_context().on_shutdown(self.move)", "def move(self, m: str):\n        return m.data"),
}  # fmt: skip
WRONG = {
    "callback": ("msg: String", "self.get_logger().info(msg.dta)", ""),
    "helper": ("msg", "self.move(msg)", "def move(self, m: String):\n        return m.dta"),
    "text": ("msg", "self.move('a')", "def move(self, m: str):\n        return m.data"),
    "formatted text": ("msg", "self.move(f'{msg.data}')", "def move(self, m: str):\n        return m + 1"),
    "both wrong": ("msg", "self.move(msg)", "def move(self, m: str):\n        return m.frobnicate"),
    "not called": ("msg", "pass", "def move(self, m: str):\n        return m.data"),
}  # fmt: skip
CODES = {"attribute-missing", "message-field", "operand-type", "argument-type", "not-callable"}


def told(folder: Path, parameter: str, line: str, methods: str) -> list[str]:
    files = right_workspace().change("listener", "callback(self, msg)", f"callback(self, {parameter})")
    files.change("listener", HEARD, f"{HEARD}        {line}\n")
    files.change(
        "listener", "    def command_callback", f"    {methods or 'extra = 1'}\n\n    def command_callback"
    )
    files.change("listener", "import String", "import Header, String")
    return [one.code for one in of_workspace(files.write(folder)) if one.code in CODES]


@pytest.mark.parametrize("way", RIGHT)
def test_a_hint_that_nothing_follows_is_no_fault(tmp_path: Path, way: str) -> None:
    assert told(tmp_path, *RIGHT[way]) == []


@pytest.mark.parametrize("way", WRONG)
def test_a_hint_that_is_followed_counts(tmp_path: Path, way: str) -> None:
    assert len(told(tmp_path, *WRONG[way])) == 1
