"""Give a node a parameter of no ROS type."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Give a node a parameter of no ROS type."""
    return LaunchDescription(
        [
            Node(package="parts", executable="shows", output="screen", parameters=[{"mixed": [1, "a"]}]),
        ]
    )
