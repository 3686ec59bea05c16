"""Push a namespace and set a parameter for a group."""

from launch import LaunchDescription
from launch.actions import GroupAction
from launch_ros.actions import Node, PushRosNamespace, SetParameter, SetRemap


def generate_launch_description() -> LaunchDescription:
    """Push a namespace and set a parameter for a group."""
    return LaunchDescription(
        [
            GroupAction(
                [
                    PushRosNamespace("outer"),
                    SetParameter("number", 5),
                    SetRemap("chatter", "gossip"),
                    PushRosNamespace("inner"),
                    Node(package="parts", executable="shows", output="screen"),
                ]
            ),
        ]
    )
