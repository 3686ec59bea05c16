"""What a function that is called once knows where it begins: the conditions of that call."""

from __future__ import annotations

import pytest

from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.grading.reading.written_ends import written_ends

SOURCE = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32, String


class Status(Node):
    def __init__(self):
        super().__init__("status")
        self.value = 0.0
        self.out = self.create_publisher(String, "/robot/status", 10)
        self.create_subscription(Float32, "/distance", self.take, 10)

    def take(self, msg):
        self.value = msg.data
        near = 1.0
        TAKE

    DEFINE
        PUBLISH

    def also(self, msg):
        pass


def main():
    rclpy.init()
    rclpy.spin(Status())
"""
SAY = "self.out.publish(String(data='well'))"


def _does(take: str, define: str, publish: str) -> list[str]:
    text = SOURCE.replace("TAKE", take).replace("DEFINE", define).replace("PUBLISH", publish)
    source = PythonSource("status", "status.py", text)
    assert source.tree.body, source.fault
    (end,) = (end for end in written_ends([source])[0] if end.is_publisher)
    return end.does or []


@pytest.mark.parametrize(
    ("take", "define", "publish"),
    [
        ("if msg.data > 5.0: self.far(msg)", "def far(self, msg):", f"if msg.data < 3.0: {SAY}"),
        ("if msg.data > 5.0: self.far(msg)", "def far(self, seen):", f"if seen.data < 3.0: {SAY}"),
        ("if msg.data > 5.0: self.far(msg.data)", "def far(self, x):", f"if x < 3.0: {SAY}"),
        ("if msg.data > 5.0: self.far(x=msg.data)", "def far(self, x):", f"if x < 3.0: {SAY}"),
        ("if self.value > 5.0: self.far()", "def far(self):", f"if self.value < 3.0: {SAY}"),
        (
            "if msg.data <= 5.0: return\n        self.far(msg)",
            "def far(self, msg):",
            f"if msg.data < 3.0: {SAY}",
        ),
        ("msg.data > 5.0 and self.far(msg)", "def far(self, msg):", f"if msg.data < 3.0: {SAY}"),
    ],
)
def test_what_shuts_a_call_out_shuts_out_what_it_calls(take: str, define: str, publish: str) -> None:
    assert _does(take, define, publish) == []


@pytest.mark.parametrize(
    ("take", "define", "publish"),
    [
        ("if msg.data > 5.0: self.far(msg)", "def far(self, msg):", f"if msg.data < 9.0: {SAY}"),
        ("if msg.data > 5.0: self.far(msg)\n        self.far(msg)", "def far(self, msg):", f"if msg.data < 3.0: {SAY}"),
        ("if near > 5.0: pass\n        self.far(msg)", "def far(self, near):", f"if near.data < 3.0: {SAY}"),
        ("if msg.data > 5.0: self.far(self.value)", "def far(self, data):", f"if data < 3.0: {SAY}"),
        ("if msg.data > 5.0: self.create_timer(1.0, self.far)", "def far(self):", f"if self.value < 3.0: {SAY}"),
        ("if self.value > 5.0: self.far()", "def far(self):", f"self.value = 1.0\n        if self.value < 3.0: {SAY}"),
        ("if self.value > 5.0: self.far()", "def far(self):", f"for self.value in (1.0, 2.0):\n            if self.value < 3.0: {SAY}"),
        ("if msg.data > 5.0: self.far(msg)", "def far(self, msg):", f"msg = Float32()\n        if msg.data < 3.0: {SAY}"),
        ("if msg.data > 5.0: getattr(self, 'f' + 'ar')(msg)\n        else: self.far(msg)", "def far(self, msg):", f"if msg.data > 5.0: {SAY}"),
        ("if msg.data > 5.0: (lambda: self.far())()", "def far(self):", f"if self.value < 3.0: {SAY}"),
    ],
)  # fmt: skip
def test_what_may_be_otherwise_by_then_shuts_nothing_out(take: str, define: str, publish: str) -> None:
    assert _does(take, define, publish) == ["publishes"]
