"""Use a launch configuration that nobody declared."""

from launch import LaunchDescription
from launch.actions import LogInfo
from launch.substitutions import LaunchConfiguration


def generate_launch_description() -> LaunchDescription:
    """Use a launch configuration that nobody declared."""
    return LaunchDescription(
        [
            LogInfo(msg=LaunchConfiguration("undeclared")),
        ]
    )
