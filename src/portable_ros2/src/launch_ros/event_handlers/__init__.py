"""Here are none: those of launch_ros are about lifecycle nodes."""

from launch.absent import absent

__getattr__ = absent(__name__, {"OnStateTransition"})
