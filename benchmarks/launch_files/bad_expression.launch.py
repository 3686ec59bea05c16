"""Evaluate what is no expression."""

from launch import LaunchDescription
from launch.actions import LogInfo
from launch.substitutions import PythonExpression


def generate_launch_description() -> LaunchDescription:
    """Evaluate what is no expression."""
    return LaunchDescription(
        [
            LogInfo(msg=PythonExpression("1 +")),
        ]
    )
