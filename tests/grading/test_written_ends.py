"""What the code makes of publishers and subscriptions, as far as it tells without being run."""

from __future__ import annotations

from pathlib import Path

import pytest

from ros2lab.diagnose.python_source import PythonSource, read_source
from ros2lab.grading.evidence import WrittenEnd
from ros2lab.grading.files import _ends, _ends_elsewhere

SOURCE = """
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import String

PERIOD = 2.0


class Status(Node):
    def __init__(self):
        super().__init__("status")
        self.speed = self.create_publisher(Twist, "cmd_vel", 10)
        self.status = self.create_publisher(String, "/robot/status", 10)
        self.create_subscription(String, "/robot/command", self.on_command, 10)
        self.create_timer(PERIOD, self.tick)
        self.create_timer(0.1, self.on_condition)

    def tick(self):
        message = String()
        self.status.publish(message)

    def on_condition(self):
        if self.speed:
            self.speed.publish(Twist())

    def on_command(self, message):
        pass
"""


def test_topics_types_and_timers_are_read() -> None:
    source = PythonSource("status", "status.py", SOURCE)
    assert _ends([source])[0] == [
        WrittenEnd("/cmd_vel", "geometry_msgs/msg/Twist", True, [], "status"),
        WrittenEnd("/robot/status", "std_msgs/msg/String", True, [2.0], "status"),
        WrittenEnd("/robot/command", "std_msgs/msg/String", False, [], "status"),
    ]


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("(PERIOD, self.tick)", "(PERIOD, self.tick"),
        ("def __init__(self):", "def __init__(self)"),
        ("(Node):", "(Node)"),
        ("message = String()", "message = String() // of the status"),
        ("message = String()", 'message = String("'),
        (
            "message = String()",
            "\n<<<<<<< HEAD\n        message = String()\n=======\n        message = String()\n>>>>>>> mine",
        ),
        ("import rclpy", "Here is the node:\n```python\nimport rclpy"),
        ("message = String()", "message = String()\n        if True\n            x = [1, 2"),
    ],
)
def test_what_a_file_makes_is_read_past_what_python_cannot_read(right: str, wrong: str) -> None:
    """It dies at once, and what its code plainly has is there all the same."""
    source = PythonSource("status", "status.py", SOURCE)
    spoilt = PythonSource("status", "status.py", SOURCE.replace(right, wrong, 1))
    assert right in SOURCE
    assert spoilt.readable_to < len(spoilt.text.split("\n"))
    assert _ends([spoilt]) == _ends([source])


def test_what_python_cannot_read_at_all_is_left_as_it_is() -> None:
    source = PythonSource("notes", "notes.py", "\n".join(["dear teacher ,"] * 20))
    assert source.as_meant() is source


PLAIN = "import rclpy\nnode = rclpy.create_node('a')\nnode.create_publisher(String, '/a', 1)\n"


@pytest.mark.parametrize(
    ("files", "publishers"),
    [
        ({}, []),
        ({"README.md": "Call create_publisher(String, '/a', 1)."}, []),
        ({"src/a/a/status.py": PLAIN.replace("node.create", "make = node.create").replace("her(", "her; make(")}, [True]),
        ({"src/a/a/status.py": f"{PLAIN}getattr(node, 'create_publisher')(String, '/b', 1)\n"}, [True]),
        ({"src/a/a/status.py": f"{PLAIN}# create_publisher\n"}, []),
        ({"src/a/scripts/talker": f"#!/usr/bin/env python3\n{PLAIN}"}, [True]),
        ({"src/b/b.cpp": "node->create_publisher<String>(topic, 1);"}, [True]),
        ({"src/a/data/table.py": "X = [\n" + "    1,\n" * 150_000 + "]\n"}, [True, False]),
    ],
    ids=["nothing", "prose", "other name", "text", "comment", "no ending", "C++", "too large"],
)  # fmt: skip
def test_what_may_make_an_end_besides_is_known(
    tmp_path: Path, files: dict[str, str], publishers: list[bool]
) -> None:
    """So that a node counts as somebody else's only where nothing that was handed in can make it."""
    for name, text in {"src/a/a/status.py": PLAIN, **files}.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    source = read_source(tmp_path / "src/a/a/status.py", "a.status", "status.py")
    paths = [path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file()]
    found = _ends_elsewhere(tmp_path, paths, [source], _ends([source])[0])
    assert [end.is_publisher for end in found] == publishers
