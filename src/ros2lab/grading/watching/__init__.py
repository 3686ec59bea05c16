"""Start a submission's programs, drive and observe them, and record what they do."""
