"""To which other values parameters are set."""

from __future__ import annotations

import math
from typing import Any

import pytest

from ros2lab.grading.watching.settings import other_values

WORDS = [["mode", "slow", "fast"], ["kind"], ["state", "idle", "running"]]


@pytest.mark.parametrize(
    ("name", "value", "wanted"),
    [
        ("period", 0.5, [0.25, 1.0, 1.5]),
        ("gain", 0.0, [1.0]),
        ("count", 10, [5, 20, 11]),
        ("count", 1, [2, 2]),
        ("limit", 2**63 - 1, [2**62]),
        ("limit", -(2**63), [-(2**62), 1 - 2**63]),
        ("most", 1.5e308, [7.5e307]),
        ("most", math.inf, []),
        ("least", -math.inf, []),
        ("offset", math.nan, []),
        ("loud", True, [False]),
        ("mode", "slow", ["fast"]),
        ("mode", "odd", ["slow"]),  # what is compared has its name
        ("begin", "idle", ["running"]),  # or its value
        ("frame_id", "base_link", []),  # it may name anything
        ("names", ["a", "b"], []),
        ("nothing", None, []),
        ("use_sim_time", True, []),
        ("qos_overrides./chatter.publisher.depth", 10, []),
    ],
)
def test_other_values_are_near(name: str, value: Any, wanted: list[Any]) -> None:
    """They are of the same type, and tried one after the other where a node refuses."""
    found = other_values(name, value, WORDS)
    assert [*map(repr, found)] == [*map(repr, wanted)]
    assert other_values(name, value, None) == []
