"""An interactive course lab for ROS 2 Jazzy.

What a notebook needs is here by name; each name is imported when it is first used, so that a command which
needs no ROS does not wait for it.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ros2lab.progress import Progress
    from ros2lab.recording import Recorder, Recording, Replay, read_recording
    from ros2lab.session import LabSession
    from ros2lab.topics import TopicLog
    from ros2lab.widgets import (
        CommandPanel,
        Dashboard,
        GraphView,
        MessageForm,
        NodeLog,
        RobotView,
        SideBySide,
        Teleop,
        TopicMonitor,
        TwistPlot,
    )
    from ros2lab.workspace import Workspace

__version__ = "0.1.0"

__all__ = [
    "CommandPanel",
    "Dashboard",
    "GraphView",
    "LabSession",
    "MessageForm",
    "NodeLog",
    "Progress",
    "Recorder",
    "Recording",
    "Replay",
    "RobotView",
    "SideBySide",
    "Teleop",
    "TopicLog",
    "TopicMonitor",
    "TwistPlot",
    "Workspace",
    "read_recording",
]

_HOMES = {
    "CommandPanel": "ros2lab.widgets",
    "Dashboard": "ros2lab.widgets",
    "GraphView": "ros2lab.widgets",
    "LabSession": "ros2lab.session",
    "MessageForm": "ros2lab.widgets",
    "NodeLog": "ros2lab.widgets",
    "Progress": "ros2lab.progress",
    "Recorder": "ros2lab.recording",
    "Recording": "ros2lab.recording",
    "Replay": "ros2lab.recording",
    "RobotView": "ros2lab.widgets",
    "SideBySide": "ros2lab.widgets",
    "Teleop": "ros2lab.widgets",
    "TopicLog": "ros2lab.topics",
    "TopicMonitor": "ros2lab.widgets",
    "TwistPlot": "ros2lab.widgets",
    "Workspace": "ros2lab.workspace",
    "read_recording": "ros2lab.recording",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
