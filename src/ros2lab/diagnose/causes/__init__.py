"""Behind the line of an error: where the value came from that fails there."""
