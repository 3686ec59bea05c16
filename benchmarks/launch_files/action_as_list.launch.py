"""Return a description with something that is no action."""

from launch import LaunchDescription


def generate_launch_description() -> LaunchDescription:
    """Return a description with something that is no action."""
    return LaunchDescription(
        [
            "a text",
        ]
    )
