"""ROS nodes in launch files, where no ROS 2 is installed: a small launch_ros for the small launch beside it.

Only what courses use is here; the rest names the real package.
"""

from __future__ import annotations

import launch as launch  # so that the paths of the real package lead here
from launch.lookup import lookup

__all__ = ["actions", "descriptions", "event_handlers", "events", "substitutions"]
__getattr__ = lookup(__name__)
