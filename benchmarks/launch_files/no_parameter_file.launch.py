"""Give a node a parameter file that is not there."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Give a node a parameter file that is not there."""
    return LaunchDescription(
        [
            Node(package="parts", executable="shows", output="screen", parameters=["/nowhere/nothing.yaml"]),
        ]
    )
