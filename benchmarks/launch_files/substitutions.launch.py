"""Log what substitutions become."""

from launch import LaunchDescription
from launch.actions import LogInfo, SetLaunchConfiguration
from launch.substitutions import (
    Command,
    EnvironmentVariable,
    FindExecutable,
    LaunchConfiguration,
    PathJoinSubstitution,
    PythonExpression,
    TextSubstitution,
    ThisLaunchFileDir,
)
from launch_ros.substitutions import ExecutableInPackage, FindPackagePrefix, FindPackageShare


def generate_launch_description() -> LaunchDescription:
    """Log what substitutions become."""
    return LaunchDescription(
        [
            SetLaunchConfiguration("number", "4"),
            LogInfo(msg=PathJoinSubstitution([FindPackageShare("parts"), "config", "values.yaml"])),
            LogInfo(msg=[FindPackagePrefix("parts"), TextSubstitution(text=" "), ThisLaunchFileDir()]),
            LogInfo(msg=EnvironmentVariable("COLUMNS")),
            LogInfo(msg=EnvironmentVariable("NOT_SET_HERE", default_value="nothing")),
            LogInfo(msg=Command(["printf ", "'%s' ", "out"])),
            LogInfo(msg=PythonExpression(["2 * ", LaunchConfiguration("number"), " + 1"])),
            LogInfo(msg=LaunchConfiguration("not_there", default="a default")),
            LogInfo(
                msg=[FindExecutable(name="true"), " ", ExecutableInPackage(executable="say", package="parts")]
            ),
        ]
    )
