"""Raise an error while the description is made."""


def generate_launch_description() -> None:
    """Raise."""
    raise RuntimeError("the robot has no wheels")
