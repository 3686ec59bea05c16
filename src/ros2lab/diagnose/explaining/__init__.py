"""Explain what was printed: the findings to which its words and the workspace lead."""
