"""Run a node that is killed."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Run a node that is killed."""
    return LaunchDescription(
        [
            Node(package="parts", executable="dies", output="screen"),
        ]
    )
