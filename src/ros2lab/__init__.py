"""An interactive course lab for ROS 2 Jazzy."""

from __future__ import annotations

__version__ = "0.1.0"
