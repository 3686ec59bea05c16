"""Nodes that wait for words which the text of their code does not show: they are sent what they ask for, or are left alone."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace
from test_trial import build

from ros2lab.trial import try_out

DOOR = """\
import json

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Door(Node):
    def __init__(self):
        super().__init__('door')
        self.events, self.is_open = set(), False
        self.out = self.create_publisher(String, '/door/state', 10)
        self.create_subscription(String, '/door/event', self.heard, 10)
        self.create_timer(0.1, self.step)

    def heard(self, msg):
        HEARD

    def take(self, event):
        found = event in self.events
        self.events.discard(event)
        return found

    def step(self):
        STEP

    def tell(self):
        self.out.publish(String(data='open'))


def main():
    rclpy.init()
    rclpy.spin(Door())
"""
ADD = "self.events.add(msg.data)"


@pytest.mark.parametrize(
    ("heard", "step", "is_told", "story"),
    [
        (ADD, "if self.take('person'): self.tell()", False, "each of them with data = 'open'"),
        pytest.param("try:\n            self.is_open = json.loads(msg.data)['open']\n        except (ValueError, TypeError, KeyError):\n            self.is_open = False", "if self.is_open: self.tell()", False, "published nothing there", marks=pytest.mark.thorough),
        (ADD, "self.is_open = self.take('person')", True, "published nothing there"),  # nothing calls tell()
    ],
)  # fmt: skip
def test_a_node_that_was_not_sent_its_event_is_not_wrong(
    tmp_path: Path, heard: str, step: str, *, is_told: bool, story: str
) -> None:
    files = right_workspace().put("listener", DOOR.replace("HEARD", heard).replace("STEP", step))
    root = files.only("listener").write(tmp_path)
    build(root)
    trial = try_out(root)
    silent = [one for one in trial.findings if one.code == "publishes-nothing"]
    assert bool(silent) is is_told, silent
    assert any(story in told for told in trial.story if "/door/state" in told), trial.story
