"""The transitions of managed nodes: what they take the place of, and what they return."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.life_faults import life_faults

NODE = """\
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String


class Gate(LifecycleNode):
    def on_configure(self, state):
        self.pub = self.create_MADE(String, 'gate', 10)
        return TransitionCallbackReturn.SUCCESS

    def NAME(self, state):
        BODY
"""


def told(name: str, body: str, folder: Path, made: str = "lifecycle_publisher") -> list[Finding]:
    text = NODE.replace("MADE", made).replace("NAME", name).replace("BODY", body)
    sources = sources_of(text, folder, "gate")
    return [one for one in life_faults(sources, None) if one.code == "transition-wrong"]


@pytest.mark.parametrize(
    ("name", "body", "fix"),
    [
        ("on_activate", "return TransitionCallbackReturn.SUCCESS", "return super().on_activate(state)"),
        ("on_deactivate", "return TransitionCallbackReturn.SUCCESS", "return super().on_deactivate(state)"),
        ("on_activate", "print('active')", "return super().on_activate(state)"),
        ("on_cleanup", "self.destroy_publisher(self.pub)", "return TransitionCallbackReturn.SUCCESS"),
        ("on_shutdown", "super().on_shutdown(state)", "return TransitionCallbackReturn.SUCCESS"),
    ],
)
def test_what_is_left_out_is_told(tmp_path: Path, name: str, body: str, fix: str) -> None:
    (found,) = told(name, body, tmp_path)
    assert fix in found.fix


@pytest.mark.parametrize(
    ("name", "body", "made"),
    [
        ("on_activate", "return super().on_activate(state)", "lifecycle_publisher"),
        ("on_activate", "self.pub.on_activate(state); return TransitionCallbackReturn.SUCCESS", "lifecycle_publisher"),
        ("on_activate", "return TransitionCallbackReturn.SUCCESS", "publisher"),
        ("on_cleanup", "return TransitionCallbackReturn.SUCCESS", "lifecycle_publisher"),
        ("on_error", "raise RuntimeError", "lifecycle_publisher"),
        ("on_message", "print(state)", "lifecycle_publisher"),
    ],
)  # fmt: skip
def test_what_does_it_all_is_left_alone(tmp_path: Path, name: str, body: str, made: str) -> None:
    assert told(name, body, tmp_path, made) == []
