"""What a submission's code would do, as far as its names and constants tell; nothing of it is run."""
