"""Choose how lines look."""

from launch import LaunchDescription
from launch.actions import ExecuteProcess


def generate_launch_description() -> LaunchDescription:
    """Choose how lines look."""
    return LaunchDescription(
        [
            ExecuteProcess(
                cmd=["bash", "-c", "printf 'one\ntwo'"],
                output="screen",
                output_format="<{this.process_description.final_name}> {line}",
            ),
        ]
    )
