"""Do some things and leave others."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import LaunchConfiguration, PythonExpression


def generate_launch_description() -> LaunchDescription:
    """Do some things and leave others."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("wanted", default_value="true"),
            LogInfo(msg="if", condition=IfCondition(LaunchConfiguration("wanted"))),
            LogInfo(msg="unless", condition=UnlessCondition(LaunchConfiguration("wanted"))),
            LogInfo(
                msg="expression",
                condition=IfCondition(PythonExpression(["'", LaunchConfiguration("wanted"), "' == '1'"])),
            ),
        ]
    )
