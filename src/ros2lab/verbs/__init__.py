"""The verbs of the `ros2lab` command, one a file."""
