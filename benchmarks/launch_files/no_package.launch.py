"""Run a node of a package that is not there."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Run a node of a package that is not there."""
    return LaunchDescription(
        [
            Node(package="nowhere", executable="say"),
        ]
    )
