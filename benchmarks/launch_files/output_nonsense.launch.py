"""Ask for an output that does not exist."""

from launch import LaunchDescription
from launch.actions import ExecuteProcess


def generate_launch_description() -> LaunchDescription:
    """Ask for an output that does not exist."""
    return LaunchDescription(
        [
            ExecuteProcess(cmd=["echo", "out"], output="nonsense"),
        ]
    )
