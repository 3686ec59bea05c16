"""Set and unset environment variables."""

from launch import LaunchDescription
from launch.actions import (
    AppendEnvironmentVariable,
    ExecuteProcess,
    SetEnvironmentVariable,
    UnsetEnvironmentVariable,
)


def generate_launch_description() -> LaunchDescription:
    """Set and unset environment variables."""
    return LaunchDescription(
        [
            SetEnvironmentVariable("COLOUR", "red"),
            AppendEnvironmentVariable("COLOUR", "blue"),
            UnsetEnvironmentVariable("COLUMNS"),
            ExecuteProcess(
                cmd=["bash", "-c", "echo $COLOUR ${COLUMNS-unset} $MORE"],
                output="screen",
                additional_env={"MORE": "more"},
            ),
            ExecuteProcess(cmd=["/usr/bin/env"], output="screen", env={"ONLY": "this"}, name="only"),
        ]
    )
