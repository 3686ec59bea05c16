"""Node classes with several bases: whose constructor is never called, and such as are right."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.nodes.super_order import constructor_left_out

NODE = """\
import abc
import argparse
import cmd
import threading
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node


class Counting:
    def __init__(self):
        self.count = 0

    def step(self):
        self.count += 1
        return self.count


class Joining:
    def __init__(self, *given):
        super().__init__(*given)
        self.joined = []


class Naming:
    def title(self):
        return 'a sonar'


class Sonar(BASES):
    def __init__(self):
        CALL
"""


@pytest.mark.parametrize(
    ("bases", "call", "left"),
    [
        ("Node, threading.Thread", "super().__init__('sonar')", "threading.Thread"),
        ("LifecycleNode, threading.Thread", "super().__init__('sonar')", "threading.Thread"),
        ("threading.Thread, Node", "super().__init__()", "Node"),
        ("Node, cmd.Cmd", "Node.__init__(self, 'sonar')", "cmd.Cmd"),
        ("Node, Counting", "super().__init__('sonar')", "Counting"),
        ("Naming, Node, threading.Thread", "super().__init__('sonar')", "threading.Thread"),
        ("Node, Naming", "super().__init__('sonar')", ""),
        ("Node, abc.ABC", "super().__init__('sonar')", ""),
        ("Joining, Node", "super().__init__('sonar')", ""),
        ("Joining, Node, threading.Thread", "super().__init__('sonar')", ""),
        ("Node", "super().__init__('sonar')", ""),
        ("Node, argparse.Namespace", "super().__init__('sonar')", ""),
        (
            "threading.Thread, Node",
            "Node.__init__(self, 'sonar'); threading.Thread.__init__(self, daemon=True)",
            "",
        ),
        ("Node, threading.Thread", "for base in Sonar.__bases__: base.__init__(self)", ""),
    ],
)
def test_the_base_whose_constructor_never_runs_is_named(
    tmp_path: Path, bases: str, call: str, left: str
) -> None:
    sources = sources_of(NODE.replace("BASES", bases).replace("CALL", call), tmp_path)
    found = constructor_left_out(sources, sources.classes["pk.node.Sonar"])
    assert bool(found) is bool(left)
    assert found is None or f"which does not call that of {left}." in found.cause
    assert found is None or "`Node.__init__(self" in found.fix or "`LifecycleNode.__init__(self" in found.fix
