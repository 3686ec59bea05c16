"""Give a node a keyword that it does not have."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Give a node a keyword that it does not have."""
    return LaunchDescription(
        [
            Node(package="parts", executable="say", nonsense=1),
        ]
    )
