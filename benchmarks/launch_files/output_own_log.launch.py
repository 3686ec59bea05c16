"""Write to both streams with output own_log."""

from launch import LaunchDescription
from launch.actions import ExecuteProcess


def generate_launch_description() -> LaunchDescription:
    """Write to both streams with output own_log."""
    return LaunchDescription(
        [
            ExecuteProcess(cmd=["bash", "-c", "echo out; sleep 0.2; echo err >&2"], output="own_log"),
        ]
    )
