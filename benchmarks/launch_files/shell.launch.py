"""Run a shell command elsewhere with a prefix."""

from launch import LaunchDescription
from launch.actions import ExecuteProcess


def generate_launch_description() -> LaunchDescription:
    """Run a shell command elsewhere with a prefix."""
    return LaunchDescription(
        [
            ExecuteProcess(cmd=["echo $((1 + 2)); pwd"], shell=True, cwd="/usr", output="screen"),
            ExecuteProcess(cmd=["echo", "prefixed"], prefix="env", output="screen"),
        ]
    )
