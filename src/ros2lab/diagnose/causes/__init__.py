"""Behind the line of an error: where the value that fails there came from."""
