"""Run a node that ignores signals."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Run a node that ignores signals."""
    return LaunchDescription(
        [
            Node(
                package="parts",
                executable="stubborn",
                output="screen",
                sigterm_timeout="1",
                sigkill_timeout="1",
            ),
        ]
    )
