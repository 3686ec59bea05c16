"""Run an executable that is not there."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Run an executable that is not there."""
    return LaunchDescription(
        [
            Node(package="parts", executable="nothing"),
        ]
    )
