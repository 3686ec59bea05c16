"""Rules over launch files, and over what they would start."""
