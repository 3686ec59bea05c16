"""Run three processes of one name."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Run three processes of one name."""
    return LaunchDescription(
        [
            Node(package="parts", executable="say", arguments=["0"], output="screen"),
            Node(package="parts", executable="say", arguments=["1"], output="screen"),
            Node(package="parts", executable="say", arguments=["2"], output="screen"),
        ]
    )
