"""Include a file that is not there."""

from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription


def generate_launch_description() -> LaunchDescription:
    """Include a file that is not there."""
    return LaunchDescription(
        [
            IncludeLaunchDescription("/nowhere/nothing.launch.py"),
        ]
    )
