"""Here are none: those of launch_ros are about lifecycle nodes."""
