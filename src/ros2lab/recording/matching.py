"""Waiting until publishers and subscribers have found each other."""

from __future__ import annotations

import time
from collections.abc import Callable

MATCH_TIMEOUT = 1.0  # s
POLL_PERIOD = 0.005  # s; rclpy sends no event for every match


def wait_for_match(has_matched: Callable[[], bool]) -> None:
    """Wait until publishers and subscribers have matched, but no longer than `MATCH_TIMEOUT`."""
    deadline = time.monotonic() + MATCH_TIMEOUT
    while not has_matched() and time.monotonic() < deadline:
        time.sleep(POLL_PERIOD)
