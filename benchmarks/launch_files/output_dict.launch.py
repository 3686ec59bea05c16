"""Send both streams to different places."""

from launch import LaunchDescription
from launch.actions import ExecuteProcess


def generate_launch_description() -> LaunchDescription:
    """Send both streams to different places."""
    return LaunchDescription(
        [
            ExecuteProcess(
                cmd=["bash", "-c", "echo out; echo err >&2"], output={"stdout": "log", "stderr": "screen"}
            ),
        ]
    )
