"""Run a node until Ctrl-C."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Run a node until Ctrl-C."""
    return LaunchDescription(
        [
            Node(package="parts", executable="waits", output="screen"),
        ]
    )
