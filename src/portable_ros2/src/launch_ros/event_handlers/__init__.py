"""Here are none: those of launch_ros are about lifecycle nodes."""

from launch.lookup import lookup

__getattr__ = lookup(__name__, absent={"OnStateTransition"})
