"""Decide with a function that raises."""

from launch import LaunchContext, LaunchDescription
from launch.actions import OpaqueFunction


def _decide(_: LaunchContext) -> None:
    raise ValueError("no decision was possible")


def generate_launch_description() -> LaunchDescription:
    """Decide with a function that raises."""
    return LaunchDescription(
        [
            OpaqueFunction(function=_decide),
        ]
    )
