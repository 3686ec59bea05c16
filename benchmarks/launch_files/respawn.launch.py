"""Start a failing process again, twice."""

from launch import LaunchDescription
from launch.actions import ExecuteProcess


def generate_launch_description() -> LaunchDescription:
    """Start a failing process again, twice."""
    return LaunchDescription(
        [
            ExecuteProcess(
                cmd=["bash", "-c", "exit 4"], respawn=True, respawn_delay=0.2, respawn_max_retries=2
            ),
        ]
    )
