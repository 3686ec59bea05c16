"""Substitute a command that warns."""

from launch import LaunchDescription
from launch.actions import LogInfo
from launch.substitutions import Command


def generate_launch_description() -> LaunchDescription:
    """Substitute a command that warns."""
    return LaunchDescription(
        [
            LogInfo(msg=Command("bash -c 'echo out; echo warning >&2'")),
        ]
    )
