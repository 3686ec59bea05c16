"""ROS nodes in launch files, where no ROS 2 is installed: a small launch_ros for the small launch beside it.

Only what courses use is here; the rest names the real package.
"""

from __future__ import annotations

import importlib
from typing import Any

import launch as launch  # so that the paths of the real package lead here

__all__ = ["actions", "descriptions", "event_handlers", "events", "substitutions"]


def __getattr__(name: str) -> Any:
    """Import what is asked for, so that `import launch_ros` costs nothing and `launch_ros.actions` is there."""
    if name in __all__:
        return importlib.import_module(f"launch_ros.{name}")
    raise AttributeError(f"module 'launch_ros' has no attribute '{name}'")
