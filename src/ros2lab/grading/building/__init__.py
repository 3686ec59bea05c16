"""Build a submission, find out how its programs start, and run its own tests."""
