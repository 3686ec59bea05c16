"""How long a test waits for what must come.

A deadline costs nothing where it comes, so one suits all: also a machine on which ten others are busy.
"""

DEADLINE = 120.0  # s
