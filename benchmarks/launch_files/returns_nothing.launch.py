"""Return no description."""


def generate_launch_description() -> None:
    """Return nothing."""
