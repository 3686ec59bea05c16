"""Here is no node of launch itself: what needs one says so."""

from launch.absent import absent

__getattr__ = absent(__name__, {"ROSAdapter", "get_ros_adapter", "get_ros_node"})
