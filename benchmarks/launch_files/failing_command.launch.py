"""Substitute a command that fails."""

from launch import LaunchDescription
from launch.actions import LogInfo
from launch.substitutions import Command


def generate_launch_description() -> LaunchDescription:
    """Substitute a command that fails."""
    return LaunchDescription(
        [
            LogInfo(msg=Command("false")),
        ]
    )
