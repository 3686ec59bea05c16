"""From what was printed, or from a look at a workspace, to the finding that explains it."""
