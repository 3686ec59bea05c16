"""`ros2 wtf hello`."""

from __future__ import annotations

from portable_ros2.commands.doctor import hello


class HelloVerb(hello.HelloVerb):
    """Check network connectivity between multiple hosts."""
