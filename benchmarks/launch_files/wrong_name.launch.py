"""Import a name that launch does not have."""

from launch.actions import LaunchTheRocket  # noqa: F401
