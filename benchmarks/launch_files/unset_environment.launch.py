"""Need an environment variable that is not set."""

from launch import LaunchDescription
from launch.actions import LogInfo
from launch.substitutions import EnvironmentVariable


def generate_launch_description() -> LaunchDescription:
    """Need an environment variable that is not set."""
    return LaunchDescription(
        [
            LogInfo(msg=EnvironmentVariable("NOT_SET_HERE")),
        ]
    )
