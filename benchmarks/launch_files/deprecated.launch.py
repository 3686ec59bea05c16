"""Compare as one should no longer do it."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo
from launch.conditions import LaunchConfigurationEquals


def generate_launch_description() -> LaunchDescription:
    """Compare as one should no longer do it."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("wanted", default_value="true"),
            LogInfo(msg="equals", condition=LaunchConfigurationEquals("wanted", "true")),
        ]
    )
