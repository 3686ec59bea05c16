"""Run a command that is not there."""

from launch import LaunchDescription
from launch.actions import ExecuteProcess


def generate_launch_description() -> LaunchDescription:
    """Run a command that is not there."""
    return LaunchDescription(
        [
            ExecuteProcess(cmd=["/nowhere/nothing"]),
        ]
    )
