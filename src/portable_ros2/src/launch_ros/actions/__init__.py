"""What can be done with nodes."""

from __future__ import annotations

from launch.lookup import lookup
from launch_ros.actions.beyond import (
    ComposableNodeContainer,
    LifecycleNode,
    LoadComposableNodes,
    ROSTimer,
)
from launch_ros.actions.node import Node
from launch_ros.actions.scope import (
    PushROSNamespace,
    SetParameter,
    SetParametersFromFile,
    SetRemap,
    SetROSLogDir,
    SetUseSimTime,
)

PushRosNamespace = PushROSNamespace
RosTimer = ROSTimer

__getattr__ = lookup(
    __name__,
    absent={
        "LifecycleTransition",
        "get_composable_node_load_request",
        "match_node_name_goal",
        "match_node_name_start_goal",
    },
)

__all__ = [
    "ComposableNodeContainer",
    "LifecycleNode",
    "LoadComposableNodes",
    "Node",
    "PushROSNamespace",
    "PushRosNamespace",
    "ROSTimer",
    "RosTimer",
    "SetParameter",
    "SetParametersFromFile",
    "SetROSLogDir",
    "SetRemap",
    "SetUseSimTime",
]
