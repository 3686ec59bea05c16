"""Give a node an absolute namespace and a ROS argument."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Give a node an absolute namespace and a ROS argument."""
    return LaunchDescription(
        [
            Node(
                package="parts",
                executable="shows",
                namespace="/far/away",
                output="screen",
                ros_arguments=["-p", "number:=9"],
            ),
        ]
    )
