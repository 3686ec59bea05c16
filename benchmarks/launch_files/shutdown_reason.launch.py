"""Shut down at once with a reason."""

from launch import LaunchDescription
from launch.actions import Shutdown


def generate_launch_description() -> LaunchDescription:
    """Shut down at once with a reason."""
    return LaunchDescription(
        [
            Shutdown(reason="nothing to do"),
        ]
    )
