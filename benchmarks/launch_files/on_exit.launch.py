"""Shut everything down when one ends."""

from launch import LaunchDescription
from launch.actions import Shutdown
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Shut everything down when one ends."""
    return LaunchDescription(
        [
            Node(package="parts", executable="waits", output="screen"),
            Node(
                package="parts", executable="say", arguments=["enough"], output="screen", on_exit=Shutdown()
            ),
        ]
    )
