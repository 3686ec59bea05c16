"""Run two commands."""

from launch import LaunchDescription
from launch.actions import ExecuteProcess


def generate_launch_description() -> LaunchDescription:
    """Run two commands."""
    return LaunchDescription(
        [
            ExecuteProcess(cmd=["echo", "hello"], output="screen"),
            ExecuteProcess(cmd=["bash", "-c", "echo one; echo two >&2"], name="both", output="screen"),
        ]
    )
