"""Declare arguments of every sort."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo
from launch.substitutions import LaunchConfiguration, TextSubstitution


def generate_launch_description() -> LaunchDescription:
    """Declare arguments of every sort."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("needed", description="Has no default"),
            DeclareLaunchArgument(
                "colour", default_value="red", choices=["red", "blue"], description="Of the robot"
            ),
            DeclareLaunchArgument("bare", default_value=""),
            DeclareLaunchArgument(
                "composed", default_value=[TextSubstitution(text="a "), LaunchConfiguration("colour")]
            ),
            LogInfo(
                msg=["needed ", LaunchConfiguration("needed"), ", colour ", LaunchConfiguration("colour")]
            ),
            LogInfo(msg=LaunchConfiguration("composed")),
        ]
    )
