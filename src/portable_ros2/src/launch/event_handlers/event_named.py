"""Which events have a name; here, because an import path cannot lead to a function that is named as it ends."""

from __future__ import annotations

from collections.abc import Callable

from launch.event import Event


def event_named(event_name: str) -> Callable[[Event], bool]:
    """Return a function that tells whether an event has a name."""
    return lambda event: event.name == event_name
