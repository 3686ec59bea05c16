"""The small programs that launch files start."""
