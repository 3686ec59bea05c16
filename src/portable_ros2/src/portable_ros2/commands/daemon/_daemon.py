"""Why there is no daemon."""

NOT_RUNNING = "The daemon is not running"
REASON = "portable_ros2 has none and needs none, since each command looks at the whole graph by itself"
