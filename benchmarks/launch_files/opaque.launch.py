"""Decide with a function."""

from launch import LaunchContext, LaunchDescription
from launch.actions import LogInfo, OpaqueFunction


def _decide(context: LaunchContext, text: str, count: int) -> list[LogInfo]:
    return [LogInfo(msg=f"{text} {number} {len(context.argv) >= 0}") for number in range(count)]


def generate_launch_description() -> LaunchDescription:
    """Decide with a function."""
    return LaunchDescription(
        [
            OpaqueFunction(function=_decide, args=["an argument"], kwargs={"count": 2}),
        ]
    )
