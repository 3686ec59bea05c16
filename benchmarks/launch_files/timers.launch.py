"""Do things later."""

from launch import LaunchDescription
from launch.actions import LogInfo, TimerAction


def generate_launch_description() -> LaunchDescription:
    """Do things later."""
    return LaunchDescription(
        [
            TimerAction(period=0.4, actions=[LogInfo(msg="second")]),
            TimerAction(period="0.2", actions=[LogInfo(msg="first")]),
        ]
    )
