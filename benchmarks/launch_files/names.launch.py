"""Give nodes names, namespaces, remappings and arguments."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Give nodes names, namespaces, remappings and arguments."""
    return LaunchDescription(
        [
            Node(
                package="parts",
                executable="shows",
                name="renamed",
                namespace="far",
                output="screen",
                remappings=[("chatter", "gossip")],
                arguments=["--free", "words"],
            ),
        ]
    )
