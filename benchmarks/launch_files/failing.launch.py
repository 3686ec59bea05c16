"""Run a node that fails."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Run a node that fails."""
    return LaunchDescription(
        [
            Node(package="parts", executable="fail", output="screen"),
        ]
    )
