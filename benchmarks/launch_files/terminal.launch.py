"""Return whether a node has a terminal."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Return whether a node has a terminal."""
    return LaunchDescription(
        [
            Node(package="parts", executable="terminal", name="with_one", output="screen", emulate_tty=True),
            Node(package="parts", executable="terminal", name="without", output="screen", emulate_tty=False),
        ]
    )
