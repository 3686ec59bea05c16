"""Start a submission's programs, drive and observe them, and record what they do."""

OWN_CLOCK = "The submission publishes /clock itself."  # a note of a run
