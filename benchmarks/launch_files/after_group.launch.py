"""Show that what a group sets ends with it."""

from launch import LaunchDescription
from launch.actions import GroupAction, LogInfo, SetLaunchConfiguration
from launch.substitutions import LaunchConfiguration


def generate_launch_description() -> LaunchDescription:
    """Show that what a group sets ends with it."""
    return LaunchDescription(
        [
            SetLaunchConfiguration("colour", "red"),
            GroupAction(
                [SetLaunchConfiguration("colour", "blue"), LogInfo(msg=LaunchConfiguration("colour"))]
            ),
            LogInfo(msg=LaunchConfiguration("colour")),
            GroupAction([SetLaunchConfiguration("colour", "green")], scoped=False),
            LogInfo(msg=LaunchConfiguration("colour")),
        ]
    )
