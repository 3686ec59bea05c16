"""What all verbs of the daemon have to say."""

NONE_NEEDED = "The daemon is not running: this ros2 has none and needs none, because each command looks at the graph itself."
