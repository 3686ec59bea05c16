"""What a terminal shows, taken apart: commands, errors, places in files."""
