"""Include files of three sorts."""

from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.substitutions import PathJoinSubstitution, ThisLaunchFileDir


def generate_launch_description() -> LaunchDescription:
    """Include files of three sorts."""
    return LaunchDescription(
        [
            IncludeLaunchDescription(PathJoinSubstitution([ThisLaunchFileDir(), "logs.launch.xml"])),
            IncludeLaunchDescription(PathJoinSubstitution([ThisLaunchFileDir(), "logs.launch.yaml"])),
        ]
    )
