"""Nodes that the ROS tests talk to."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from ros2lab.session import LabSession


@pytest.fixture
def session(domain_id: int) -> Iterator[LabSession]:
    """A session in the test's own domain."""
    with LabSession(domain_id=domain_id) as session:
        yield session
