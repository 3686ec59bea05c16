"""Here is no node of launch itself: what needs one says so."""

from launch.lookup import lookup

__getattr__ = lookup(__name__, absent={"ROSAdapter", "get_ros_adapter", "get_ros_node"})
